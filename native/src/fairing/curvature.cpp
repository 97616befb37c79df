#include "tripatch/fairing/curvature.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tripatch/math/linear.h"
#include "tripatch/math/places.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

class Bends final : public JetSurface<Bends> {
public:
  /// fields: what the second derivative across side i gains; empty: nothing.
  explicit Bends(std::array<PiecewisePolynomial, 3> fields) : fields_(std::move(fields)) {}

  Vec3 corner(int) const { return Vec3::Zero(); }

  template <int N>
  JetPoint<N> at(const Barycentric<N>& b) const {
    JetPoint<N> p;
    const std::array<Jet<N>, 3> w = cubic_side_weights(b);
    for (int i = 0; i < 3; ++i)
      if (!fields_[i].empty()) p += (0.5 * (square(b[i]) * w[i])) * compose(fields_[i], ray_parameter(b, i));
    return p;
  }

private:
  std::array<PiecewisePolynomial, 3> fields_;
};

}  // namespace

std::vector<Across> derivatives_across(const Surface& patch, int i, std::span<const double> t, int order) {
  const Index n = static_cast<Index>(t.size()), row = jet_size(order);
  std::vector<double> b(3 * t.size()), jets(3 * row * n);
  for (Index k = 0; k < n; ++k) {
    b[3 * k + i] = 0;
    b[3 * k + (i + 1) % 3] = 1 - t[k];
    b[3 * k + (i + 2) % 3] = t[k];
  }
  patch.evaluate(b.data(), n, order, jets.data());
  const double d0 = i == 0 ? -1 : 0.5, d1 = i == 1 ? -1 : 0.5;
  std::vector<Across> out(t.size());
  for (Index k = 0; k < n; ++k) {
    const auto derivative = [&](Index which) { return Vec3::Map(&jets[3 * (row * k + which)]); };
    out[k].first = d0 * derivative(1) + d1 * derivative(2);
    if (order > 1) out[k].second = 2 * (d0 * d0 * derivative(3) + d0 * d1 * derivative(4) + d1 * d1 * derivative(5));
  }
  return out;
}

double SideForm::across(const Vec3& v) const { return (v - v.dot(dc) / dc.squaredNorm() * dc).squaredNorm(); }

double SideForm::operator()(const Vec3& v) const {
  const Eigen::Vector2d x = in_frame(r, dc, v);
  return x[0] * x[0] * rr + 2 * x[0] * x[1] * rc + x[1] * x[1] * cc;
}

double SideForm::squared_norm() const {
  const double length = dc.norm(), slant = r.dot(dc) / (length * length), height = std::sqrt(across(r));
  const double a = cc / (length * length), b = (rc - slant * cc) / (length * height),
               c = (rr - 2 * slant * rc + slant * slant * cc) / (height * height);
  return a * a + 2 * b * b + c * c;
}

SideForm side_form(const Side& side, double t) {
  std::array<double, 9> c;
  std::array<double, 6> r;
  std::array<double, 3> q = {0, 0, 0};
  side.c.taylor(t, 2, c.data());
  side.r.taylor(t, 1, r.data());
  if (!side.q.empty()) side.q.taylor(t, 0, q.data());
  SideForm form;
  form.r = Vec3::Map(r.data());
  form.dc = Vec3::Map(c.data() + 3);
  form.n = form.r.cross(form.dc).stableNormalized();
  form.rr = form.n.dot(Vec3::Map(q.data()));
  form.rc = form.n.dot(Vec3::Map(r.data() + 3));
  form.cc = 2 * form.n.dot(Vec3::Map(c.data() + 6));
  return form;
}

Vec3 upright_across(const Side& side, double t) {
  const Vec3 along = side.c.derivative_at(t), r = side.r(t);
  return (r - r.dot(along) / along.squaredNorm() * along).normalized();
}

Vec3 upright_bend(const Side& side, double t) {
  const SideForm form = side_form(side, t);
  return form(upright_across(side, t)) * form.n;
}

Vec3 lacking_curvature(const Side& side, double t, const Across& across) {
  const SideForm form = side_form(side, t);
  return (form(across.first) - form.n.dot(across.second)) * form.n;
}

std::array<double, 3> curvature_mismatch(const Sides& sides) {
  std::array<double, 3> out;
  for (int k = 0; k < 3; ++k) {
    const Side &in = sides[(k + 1) % 3], &from = sides[(k + 2) % 3];
    if (in.q.empty() || from.q.empty() || in.r.empty() || from.r.empty()) {
      out[k] = std::numeric_limits<double>::infinity();
      continue;
    }
    const SideForm a = side_form(in, 1), b = side_form(from, 0);
    // three directions in a's plane determine the difference
    const Vec3 x = a.dc.normalized();
    const auto matrix = [&](const SideForm& f) {
      const auto flat = [&](const Vec3& v) { return (v - f.n.dot(v) * f.n).normalized().eval(); };
      const Vec3 u = flat(x), v = f.n.cross(u), w = (u + v) / std::sqrt(2.0);
      const double uu = f(u), vv = f(v);
      return Eigen::Vector3d(uu, std::sqrt(2.0) * (f(w) - 0.5 * (uu + vv)), vv);
    };
    const Eigen::Vector3d p = matrix(a), q = matrix(b);
    const double larger = std::max(p.norm(), q.norm());
    out[k] = larger > 0 ? (p - q).norm() / larger : 0;
  }
  return out;
}

std::array<bool, 3> curvature_agrees(const Sides& sides) {
  const std::array<double, 3> mismatch = curvature_mismatch(sides);
  std::array<bool, 3> agree;
  for (int i = 0; i < 3; ++i) agree[i] = mismatch[(i + 1) % 3] <= curvatures_agree && mismatch[(i + 2) % 3] <= curvatures_agree;
  return agree;
}

SurfacePtr meet_curvature(const SurfacePtr& patch, const Sides& sides, const std::array<bool, 3>& wanted) {
  constexpr double precision = 1e-7;  // of the curvature, where the sides are smooth
  std::array<PiecewisePolynomial, 3> fields;
  for (int i = 0; i < 3; ++i) {
    if (!wanted[i]) continue;
    const auto lacking = [&](std::span<const double> t, std::span<double> out) {
      const std::vector<Across> across = derivatives_across(*patch, i, t);
      for (std::size_t k = 0; k < t.size(); ++k) Vec3::Map(&out[3 * k]) = lacking_curvature(sides[i], t[k], across[k]);
    };
    double scale = 0, largest = 0;
    const std::vector<double> probe = scattered(7);
    std::vector<double> lacks(3 * probe.size());
    lacking(probe, lacks);
    const std::vector<Across> across = derivatives_across(*patch, i, probe);
    for (std::size_t k = 0; k < probe.size(); ++k) {
      const SideForm form = side_form(sides[i], probe[k]);
      scale = std::max(scale, std::sqrt(form.squared_norm()) * form.across(across[k].first));
      largest = std::max(largest, Vec3::Map(&lacks[3 * k]).norm());
    }
    const double to =
        largest > 0 ? std::clamp(precision * scale / largest, tolerance::solved, share::hundredth) : share::hundredth;
    fields[i] = fit_between_vertices(sides[i], to, lacking);
  }
  return sum(patch, std::make_shared<Bends>(std::move(fields)));
}

}  // namespace tripatch
