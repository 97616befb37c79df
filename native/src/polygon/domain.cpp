#include "tripatch/polygon/domain.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "tripatch/math/linear.h"
#include "tripatch/math/places.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"
#include "tripatch/types.h"

namespace tripatch {
namespace {

double cross(const Vec2& a, const Vec2& b) { return a[0] * b[1] - a[1] * b[0]; }

/// A corner that turns by less is seen as one that does (radians; 12 degrees): two sides nearly on one line have no parameters, and a
/// regular polygon of twelve sides turns by 30.
constexpr double min_turn = 0.2;
/// And by more: 150 degrees, a corner of 30.
constexpr double max_turn = 2.6;
/// A corner of a lens is no wider (radians; 103 degrees): higher ones crowd their parameters at the corners (of lenses with corners of
/// 128 to 170 degrees on spheres, tori and saddles those with 120 were filled twice as far off).
constexpr double widest_corner = 1.8;
/// A side of the domain is no shorter than this share of the hole's own: else the angles give way.
constexpr double min_length = 0.4;
/// Of the mean length: shorter sides of a hole are drawn as long, for their parameters would crowd. A choice.
constexpr double shortest_side = share::quarter;

/// Lengths as near to those given (relative) as closes a polygon with these turns.
Eigen::VectorXd closing_lengths(const std::vector<double>& turns, const std::vector<double>& lengths) {
  const Index n = static_cast<Index>(turns.size());
  Eigen::MatrixXd directions(2, n);
  Eigen::VectorXd wanted(n);
  double angle = 0;
  for (Index i = 0; i < n; ++i) {
    if (i > 0) angle += turns[i];
    wanted[i] = lengths[i];
    directions.col(i) << std::cos(angle) * wanted[i], std::sin(angle) * wanted[i];
  }
  // factors of the lengths, nearest to 1
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(n);
  const Eigen::MatrixXd correction = least_squares(directions, -directions * ones);
  return wanted.cwiseProduct(ones + correction.col(0));
}

/// Angles and lengths of what numbers beyond all measure made.
void check_measured(const std::vector<double>& measured) {
  for (double each : measured)
    if (!std::isfinite(each)) throw CodedRefusal(Code::numbers_overflow);
}

}  // namespace

PolygonDomain::PolygonDomain(std::vector<Vec2> corners) : corners_(std::move(corners)) {
  const int n = sides();
  if (n < 3 || n > max_sides) throw InvalidArgument("a polygon has from 3 to " + std::to_string(max_sides) + " corners");
  for (int i = 0; i < n; ++i) {
    const Vec2 along = (corner(i + 1) - corner(i)).normalized();
    inward_.emplace_back(-along[1], along[0]);
    center_ += corner(i) / n;
  }
  for (int i = 0; i < n; ++i) {
    turn_.push_back(cross(inward(i - 1), inward(i)));
    if (!(turn_.back() > tolerance::slight)) throw InvalidArgument("the domain must be convex, without straight angles");
    reach_.push_back({inward(i - 1).dot(corner(i + 1) - corner(i)), inward(i + 1).dot(corner(i) - corner(i + 1))});
    radius_ = std::max(radius_, (corner(i) - center_).norm());
  }
  bubble_at_center_ = place<0>(center_[0], center_[1]).bubble.value();
}

int PolygonDomain::corner_at(const Vec2& p, double share) const {
  for (int i = 0; i < sides(); ++i)
    if ((p - corner(i)).norm() <= share * radius_) return i;
  return -1;
}

Vec2 PolygonDomain::moved_off(int i, const Vec2& p, double share) const {
  if (is_lens()) {  // on a parabola through the two corners
    const double s = this->share(Jet<0>(p[0])).value(), hill = 4 * height_ * s * (1 - s),
                 part = hill > 0 ? std::clamp(p[1] / hill, -1.0, 1.0) : 0;
    const double there = share * radius_ / Vec2(2 * radius_, 4 * height_ * part).norm();
    const double y = part * 4 * height_ * there * (1 - there), x = radius_ * (1 - 2 * there);
    return {i == 0 ? -x : x, y};
  }
  const Vec2 off = p - corner(i), middle = (corner(i + 1) - corner(i)).normalized() + (corner(i - 1) - corner(i)).normalized();
  return corner(i) + share * radius_ * (off.norm() > tolerance::tiny * radius_ ? off : middle).normalized();
}

PolygonDomain PolygonDomain::lens(double length, double height) {
  if (!(length > 0) || !(height > 0)) throw InvalidArgument("a lens has a length and a height");
  PolygonDomain d;
  d.corners_ = {Vec2(-0.5 * length, 0), Vec2(0.5 * length, 0)};
  d.inward_ = {Vec2::UnitY(), -Vec2::UnitY()};
  d.radius_ = 0.5 * length;
  d.height_ = height;
  return d;
}

Vec2 PolygonDomain::kept_inside(Vec2 p, double margin) const {
  if (is_lens()) {
    const double widest = std::sqrt(std::max(0.0, 1 - margin / height_)) * radius_;  // where the hill is as high as the margin
    p[0] = std::clamp(p[0], -widest, widest);
  }
  for (int pass = 0; pass < 2; ++pass)
    for (int i = 0; i < sides(); ++i) p -= std::min(0.0, phi(i, p) - margin) * inward(i);
  return p;
}

PolygonDomain lens_like(const std::vector<double>& turns) {
  check_measured(turns);
  const double turn = std::clamp(0.5 * (turns[0] + turns[1]), std::numbers::pi - widest_corner, max_turn);
  const double height = 0.5 * std::tan(0.5 * (std::numbers::pi - turn));  // over half the length
  const PolygonDomain unit = PolygonDomain::lens(2, height);
  double length = 0;
  Vec2 before = unit.corner(0);
  for (const double t : evenly(32)) {
    const Vec2 at = unit.on_side(0, t);
    length += (at - before).norm();
    before = at;
  }
  return PolygonDomain::lens(2 / length, height / length);
}

PolygonDomain polygon_like(std::vector<double> turns, const std::vector<double>& given) {
  check_measured(turns);
  check_measured(given);
  const std::size_t n = turns.size();
  const double equal = 2 * std::numbers::pi / static_cast<double>(n);
  double mean = 0;
  for (double l : given) mean += l / static_cast<double>(n);
  std::vector<double> lengths;
  for (double l : given) lengths.push_back(std::max(l / mean, shortest_side));
  for (int round = 0; round < 60; ++round) {  // a whole turn, each within its bounds
    double sum = 0;
    for (double& t : turns) {
      t = std::clamp(t, std::min(min_turn, equal), max_turn);
      sum += t;
    }
    for (double& t : turns) t *= 2 * std::numbers::pi / sum;
  }
  Eigen::VectorXd closed;
  for (const double share : evenly(8)) {
    std::vector<double> now;
    for (double t : turns) now.push_back(t + (equal - t) * share);
    std::vector<double> wanted;
    for (double l : lengths) wanted.push_back(share < 1 ? l : 1);
    closed = closing_lengths(now, wanted);
    bool good = true;
    for (std::size_t i = 0; i < n; ++i) good = good && closed[static_cast<Index>(i)] > min_length * wanted[i];
    if (!good) continue;
    turns = now;
    break;
  }
  closed *= static_cast<double>(n) / closed.sum();
  std::vector<Vec2> corners = {Vec2::Zero()};
  double angle = 0;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    if (i > 0) angle += turns[i];
    corners.push_back(corners.back() + closed[static_cast<Index>(i)] * Vec2(std::cos(angle), std::sin(angle)));
  }
  Vec2 center = Vec2::Zero();
  for (const Vec2& c : corners) center += c / static_cast<double>(n);
  for (Vec2& c : corners) c -= center;
  return PolygonDomain(std::move(corners));
}

}  // namespace tripatch
