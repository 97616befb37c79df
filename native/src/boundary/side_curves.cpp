#include "tripatch/boundary/side_curves.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "tripatch/math/parallel.h"
#include "tripatch/math/smoothstep.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

/// Cosine of the angle of a rim normal to their mean, 84 degrees, from which on the rim counts as a graph over one plane; nothing of
/// it at a right angle.
constexpr double graph_from = share::tenth;
/// Of a cross derivative: the least part that leads across the rim, which is a slant of 73 degrees.
constexpr double min_across = 0.3;
/// A bend up to this over the square of the spacing, for vertices that deviate by 1, is noise.
constexpr double bent_by_noise = 15;
/// That bend is replaced by this much less once: nearly its opposite, with which a curve through noisy vertices oscillates
/// least between them.
constexpr double against_noise = 1.9;

PiecewisePolynomial spline(const std::vector<double>& t, const std::vector<Vec3>& values) {
  std::vector<double> flat;
  for (const Vec3& p : values) flat.insert(flat.end(), p.data(), p.data() + 3);
  return PiecewisePolynomial::spline(t, flat, 3);
}

/// Second derivatives for a curve through values with first derivatives: those of the two cubic Hermite pieces at each parameter,
/// averaged, the shorter piece counting more.
std::vector<Vec3> second_derivatives(const std::vector<double>& t, const std::vector<Vec3>& value,
                                     const std::vector<Vec3>& first) {
  std::vector<Vec3> second(t.size(), Vec3::Zero());
  std::vector<double> weight(t.size(), 0);
  for (std::size_t k = 0; k + 1 < t.size(); ++k) {
    const double h = t[k + 1] - t[k];
    const Vec3 slope = (value[k + 1] - value[k]) / h;
    second[k] += (6 * slope - 4 * first[k] - 2 * first[k + 1]) / (h * h);
    second[k + 1] += (2 * first[k] + 4 * first[k + 1] - 6 * slope) / (h * h);
    weight[k] += 1 / h;
    weight[k + 1] += 1 / h;
  }
  for (std::size_t k = 0; k < t.size(); ++k) second[k] /= weight[k];
  return second;
}

/// C2 curve of degree 5 through values with first and second derivatives.
PiecewisePolynomial quintic_spline(const std::vector<double>& t, const std::vector<Vec3>& value, const std::vector<Vec3>& first,
                                   const std::vector<Vec3>& second) {
  std::vector<double> coefficients;
  for (std::size_t k = 0; k + 1 < t.size(); ++k) {
    // about the middle, u from -1 to 1: even and odd parts
    const double h = 0.5 * (t[k + 1] - t[k]);
    const Vec3 p0 = (value[k] + value[k + 1]) / 2, m0 = (value[k + 1] - value[k]) / 2;
    const Vec3 p1 = h * (first[k + 1] - first[k]) / 2, m1 = h * (first[k] + first[k + 1]) / 2;
    const Vec3 p2 = h * h * (second[k] + second[k + 1]) / 2, m2 = h * h * (second[k + 1] - second[k]) / 2;
    std::array<Vec3, 6> c;
    c[4] = (p2 - p1) / 8;
    c[2] = (p1 - 4 * c[4]) / 2;
    c[0] = p0 - c[2] - c[4];
    c[5] = (m2 - 3 * m1 + 3 * m0) / 8;
    c[3] = (m1 - m0 - 4 * c[5]) / 2;
    c[1] = m0 - c[3] - c[5];
    double power = 1;
    for (const Vec3& v : c) {
      for (int x = 0; x < 3; ++x) coefficients.push_back(v[x] / power);
      power *= h;
    }
  }
  return {t, 5, 3, coefficients};
}

/// v of the plane with normal `from` carried into the plane with normal `to` without turning (Levi-Civita's transport), by
/// Rodrigues' formula.
Vec3 carried(const Vec3& v, const Vec3& from, const Vec3& to) {
  const Vec3 axis = from.cross(to);
  return v + axis.cross(v) + axis.cross(axis.cross(v)) / std::max(1 + from.dot(to), tolerance::rounding);
}

/// The cross derivative to be read at each vertex of a side with normals n and derivatives dc. It has unit length across the
/// side. Along the side it mixes what the cross derivatives at the corners have, so that the linear alpha and beta of the ribbons
/// need not undo it. Where the rim faces one way, `up`, mixed as they are and laid into the planes along it, as in a graph's own
/// chart (graph = 1); elsewhere carried along the side (graph = 0).
std::vector<Vec3> cross_derivatives(const std::vector<double>& t, const std::vector<Vec3>& n, const std::vector<Vec3>& dc,
                                    const Vec3& start, const Vec3& end, const Vec3& up, double graph) {
  const std::size_t last = n.size() - 1;
  const auto flat = [&](const Vec3& v, std::size_t k) { return Vec3(v - n[k] * n[k].dot(v)); };
  std::vector<Vec3> forth(n.size()), back(n.size()), r;
  forth[0] = flat(start, 0);
  back[last] = flat(end, last);
  for (std::size_t k = 1; k <= last; ++k) {
    forth[k] = flat(carried(forth[k - 1], n[k - 1], n[k]), k);
    back[last - k] = flat(carried(back[last - k + 1], n[last - k + 1], n[last - k]), last - k);
  }
  for (std::size_t k = 0; k <= last; ++k) {
    Vec3 wanted = (1 - t[k]) * forth[k] + t[k] * back[k];
    if (graph > 0) {
      const Vec3 mixed = (1 - t[k]) * start + t[k] * end, way = up + std::max(graph_from - up.dot(n[k]), 0.0) * n[k];
      wanted += graph * (mixed - way * (mixed.dot(n[k]) / way.dot(n[k])) - wanted);
    }
    const Vec3 across = dc[k].cross(n[k]).normalized(), along = dc[k].normalized();
    // where the rim hardly turns at the corners: no more than a slant of about 73 degrees
    const double out = wanted.dot(across), least = min_across * wanted.norm();
    r.push_back(across + wanted.dot(along) / (0.5 * (out + std::sqrt(out * out + 4 * least * least))) * along);
  }
  return r;
}

/// The spline's derivatives, laid into the planes.
std::vector<Vec3> tangents_in_planes(const SideDraft& side) {
  std::vector<Vec3> tangents;
  const PiecewisePolynomial draft = curve_through(side);
  for (int k = 0; k <= side.edges(); ++k) {
    const Vec3 along = draft.derivative_at(side.t[k]);
    Vec3 flat = along - side.normal[k] * side.normal[k].dot(along);
    // one edge: the length that makes a circular arc of two equal angles, |chord| / cos^2(angle / 2)
    const double cosine = flat.norm() / along.norm();
    flat *= (side.edges() == 1 ? 2 / (1 + cosine) : 1) / cosine;
    tangents.push_back(flat);
  }
  return tangents;
}

/// The second derivatives of a curve, along the normals those of the surface. Along the normal the curve bends as the surface does,
/// unless the difference is no more than the noise of the vertices makes: then by twice as much the other way.
void bend_as_surface(const SideDraft& side, const std::vector<Vec3>& dc, double noise, std::vector<Vec3>& ddc) {
  for (int k = 0; k <= side.edges(); ++k) {
    const Vec3& n = side.normal[k];
    const double h = std::min(k > 0 ? side.t[k] - side.t[k - 1] : 1, k < side.edges() ? side.t[k + 1] - side.t[k] : 1);
    const double wanted = dc[k].dot(side.second[k] * dc[k]), differs = n.dot(ddc[k]) - wanted;
    const double noisy = noise * std::pow(bent_by_noise / (h * h), 2);
    ddc[k] += n * (differs * (against_noise * noisy / (noisy + differs * differs) - 1));
  }
}

/// The curve through a side's vertices, in scene units. dc: first derivatives.
PiecewisePolynomial position_curve(const SideDraft& side, std::vector<Vec3> dc, double scale, double noise) {
  std::vector<Vec3> ddc = second_derivatives(side.t, side.position, dc);
  bend_as_surface(side, dc, noise, ddc);
  for (std::vector<Vec3>* derivatives : {&dc, &ddc})
    for (Vec3& v : *derivatives) v *= scale;
  return quintic_spline(side.t, side.point, dc, ddc);
}

/// First and second derivatives across a side, in scene units. r: the directions across at its vertices.
void set_across(const SideDraft& side, const std::vector<Vec3>& dc, std::vector<Vec3> r, double scale, Side& curves) {
  std::vector<Vec3> dr, q;
  for (int k = 0; k <= side.edges(); ++k) {
    r[k] *= side.length;
    q.push_back(r[k].dot(side.second[k] * r[k]) * side.normal[k]);
  }
  const PiecewisePolynomial draft_r = spline(side.t, r);
  for (int k = 0; k <= side.edges(); ++k) {
    const Vec3 &n = side.normal[k], v = draft_r.derivative_at(side.t[k]);
    dr.push_back(v + n * (r[k].dot(side.second[k] * dc[k]) - n.dot(v)));
  }
  curves.r = scale * quintic_spline(side.t, r, dr, second_derivatives(side.t, r, dr));
  curves.q = scale * spline(side.t, q);
}

}  // namespace

PiecewisePolynomial curve_through(const SideDraft& side) { return spline(side.t, side.position); }

Sides side_curves(const std::array<SideDraft, 3>& drafts, double scale, double noise) {
  Vec3 up = Vec3::Zero();
  for (const SideDraft& side : drafts)
    for (const Vec3& n : side.normal) up += n;
  up.normalize();
  double graph = 1;
  for (const SideDraft& side : drafts)
    for (const Vec3& n : side.normal) graph = std::min(graph, smoothstep(n.dot(up) / graph_from));
  const bool long_rim = is_long(drafts[0].vertex.size() + drafts[1].vertex.size() + drafts[2].vertex.size());
  std::array<std::vector<Vec3>, 3> tangents;
  each_at_once(3, [&](Index i) { tangents[i] = tangents_in_planes(drafts[i]); }, long_rim);

  Sides sides;
  const auto complete = [&](Index half) {
    const Index i = half / 2;
    const SideDraft& side = drafts[i];
    const std::vector<Vec3>& dc = tangents[i];
    if (half % 2 == 0) {
      sides[i].c = position_curve(side, dc, scale, noise);
      sides[i].rim = side.t;
    } else {
      const Vec3 start = tangents[(i + 2) % 3].back() + 0.5 * dc.front(), end = -tangents[(i + 1) % 3].front() - 0.5 * dc.back();
      set_across(side, dc, cross_derivatives(side.t, side.normal, dc, start, end, up, graph), scale, sides[i]);
    }
  };
  each_at_once(6, complete, long_rim);
  return sides;
}

}  // namespace tripatch
