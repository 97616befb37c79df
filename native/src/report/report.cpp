#include "tripatch/report/report.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "tripatch/fairing/kinks.h"
#include "tripatch/patch/rim_normals.h"

namespace tripatch {
namespace {

/// Degrees, exact for small angles too (acos loses them).
double angle(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI; }

}  // namespace

void measure_seam(const Surface& patch, const Sides& sides, Report& report, int samples) {
  constexpr double same_plane = 1e-6;  // degrees
  std::array<bool, 3> clear;           // corner: one tangent plane for both sides
  for (int k = 0; k < 3; ++k) clear[k] = angle(sides[(k + 1) % 3].normal(1), sides[(k + 2) % 3].normal(0)) <= same_plane;

  double sum = 0;
  Index count = 0;
  report.seam_angle_max = 0;
  for (int i = 0; i < 3; ++i) {
    const double first = clear[(i + 1) % 3] ? 0 : 0.01, last = clear[(i + 2) % 3] ? 1 : 0.99;
    Points b = Points::Zero(samples, 3);
    for (int k = 0; k < samples; ++k) {
      const double t = samples > 1 ? first + (last - first) * k / (samples - 1) : 0.5;
      b(k, (i + 1) % 3) = 1 - t;
      b(k, (i + 2) % 3) = t;
    }
    const Points normals = patch.normals(b);
    double largest = 0, squares = 0;
    Index used = 0;
    for (int k = 0; k < samples; ++k) {
      const Vec3 n = sides[i].normal(b(k, (i + 2) % 3));
      if (!(n.norm() > 0)) continue;  // the surroundings have no plane there
      // no plane of the fill: as bad as at a right angle
      const double a = normals.row(k).norm() > 0 ? angle(normals.row(k), n) : 90;
      largest = std::max(largest, a);
      squares += a * a;
      ++used;
    }
    report.seam_angle_max_by_side[i] = largest;
    report.seam_angle_rms_by_side[i] = used ? std::sqrt(squares / static_cast<double>(used)) : 0;
    report.seam_angle_max = std::max(report.seam_angle_max, largest);
    sum += squares;
    count += used;
  }
  report.seam_angle_rms = count ? std::sqrt(sum / static_cast<double>(count)) : 0;
}

Index count_folds(const Surface& patch, const Sides& sides) {
  constexpr Index rows = 64;
  Points b((rows + 1) * (rows + 2) / 2, 3);
  auto place = [](Index p, Index q) { return q * (rows + 1) - q * (q - 1) / 2 + p; };
  for (Index q = 0; q <= rows; ++q)
    for (Index p = 0; p + q <= rows; ++p) b.row(place(p, q)) << rows - p - q, p, q;
  b /= rows;
  const Points normals = patch.normals(b);
  const RimNormals rim(sides);

  Index folds = 0;
  for (Index k = 0; k < b.rows(); ++k) {
    const double* at = b.row(k).data();
    folds += vertex_of(at) < 0 && !(normals.row(k).dot(rim.at(at)) > 0);
  }
  // Beside a corner or kink whose planes differ every patch turns fast: neighbours there are not compared.
  std::array<bool, 3> clear;
  for (int k = 0; k < 3; ++k) clear[k] = angle(sides[(k + 1) % 3].normal(1), sides[(k + 2) % 3].normal(0)) < 1;
  std::vector<Vec3> creases;
  for (int i = 0; i < 3; ++i)
    for (double t : kinks_of(sides[i])) {
      if (planes_apart(sides[i], t) < 1) continue;
      creases.push_back(Vec3::Zero());
      creases.back()[(i + 1) % 3] = 1 - t;
      creases.back()[(i + 2) % 3] = t;
    }
  auto far_apart = [&](Index a, Index c) {
    for (int k = 0; k < 3; ++k)
      if (!clear[k] && b(a, k) > 0.85) return false;
    for (const Vec3& crease : creases)
      if ((b.row(a).transpose() - crease).cwiseAbs().maxCoeff() < 0.15) return false;
    const Vec3 p = normals.row(a), q = normals.row(c);
    return p.dot(q) <= 0.5 && p.norm() > 0 && q.norm() > 0;  // 60 degrees
  };
  for (Index q = 0; q < rows; ++q)
    for (Index p = 0; p + q < rows; ++p) {
      folds += far_apart(place(p, q), place(p + 1, q));
      folds += far_apart(place(p, q), place(p, q + 1));
      folds += far_apart(place(p + 1, q), place(p, q + 1));
    }
  return folds;
}

}  // namespace tripatch
