#include "tripatch/creases/pieces.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numeric>

#include "tripatch/math/angle.h"
#include "tripatch/math/decompositions.h"
#include "tripatch/mesh/submesh.h"
#include "tripatch/mesh/vertex_normals.h"

namespace tripatch {
namespace {

/// Of the hole's diameter: vertices of one plane are no farther from it.
constexpr double in_plane_share = 1e-4;
/// Standard deviations of the noise: vertices of a piece are no farther from it.
constexpr double in_piece = 3;
/// Of a piece that is as far from its mean plane as the field's noise explains that plane is all that is known.
constexpr double as_noise = 2;
/// Of an edge: noisier faces are no smooth piece (rough_noise of field.cpp).
constexpr double rough_noise_share = 0.04;
/// Between a piece's mean plane and its faces: heights over the plane tell nothing of steeper ones.
constexpr double steepest = 60 * std::numbers::pi / 180;
/// The nearest to the rim: farther ones change no fill of 168 holes by more than 1%, and the time grows with their square.
constexpr std::size_t most_samples = 400;
/// Between the normals of one plane's pieces.
constexpr double one_plane = 1 * std::numbers::pi / 180;

Points some_rows(const Points& points, const std::vector<std::size_t>& rows) {
  Points out(static_cast<Index>(rows.size()), 3);
  for (std::size_t k = 0; k < rows.size(); ++k) out.row(static_cast<Index>(k)) = points.row(static_cast<Index>(rows[k]));
  return out;
}

}  // namespace

SmoothPiece::SmoothPiece(const Mesh& mesh, std::vector<Index> faces, const Points& rim, double across)
    : faces_(std::move(faces)) {
  const auto distance = [&](const Vec3& p) { return (rim.rowwise() - p.transpose()).rowwise().squaredNorm().minCoeff(); };
  Vec3 sum = Vec3::Zero();
  std::vector<double> from_rim;
  std::vector<Vec3> normals;
  for (const Index f : faces_) {
    Vec3 middle = Vec3::Zero();
    for (const Index v : mesh.faces[f]) middle += Vec3(mesh.vertices.row(v)) / static_cast<double>(mesh.faces[f].size());
    const double far = distance(middle) / (across * across);
    normals.push_back(area_vector(mesh, f));
    sum += std::exp(-far * 10) * normals.back();  // a third of the diameter away counts a third
  }
  normal_ = sum.stableNormalized();
  Numbering vertices;
  for (std::size_t k = 0; k < faces_.size(); ++k)
    if (angle_between(normals[k], normal_) < steepest)
      for (const Index v : mesh.faces[faces_[k]]) vertices.add(v);
  const Points all = mesh.vertices(vertices.items(), Eigen::all);
  std::vector<std::size_t> order(vertices.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  if (order.size() > most_samples) {
    for (Index k = 0; k < all.rows(); ++k) from_rim.push_back(distance(all.row(k)));
    std::ranges::stable_sort(order, {}, [&](std::size_t k) { return from_rim[k]; });
    order.resize(most_samples);
  }
  samples_ = some_rows(all, order);
  if (samples_.rows() < 3) return;
  double area = 0;
  for (const Vec3& n : normals) area += n.norm() / 2;
  edge_ = std::sqrt(area / static_cast<double>(faces_.size()));
  fit(across);
}

SmoothPiece::SmoothPiece(const Vec3& normal, const Vec3& point, double across)
    : middle_(point), normal_(normal), is_plane_(true), tolerance_(in_plane_share * across) {}

void SmoothPiece::fit(double across) {
  middle_ = samples_.colwise().mean().transpose();
  const Points centered = samples_.rowwise() - middle_.transpose();
  const Vec3 mean = normal_;
  const SymmetricEigen axes = symmetric_eigen(Eigen::MatrixXd(centered.transpose() * centered));
  normal_ = axes.vectors.col(0);
  if (normal_.dot(mean) < 0) normal_ = -normal_;
  const Eigen::VectorXd heights = centered * normal_;
  const double far = heights.cwiseAbs().maxCoeff(), rms = std::sqrt(heights.squaredNorm() / static_cast<double>(heights.size()));
  tolerance_ = in_plane_share * across;
  is_plane_ = far < tolerance_ && angle_between(normal_, mean) < steepest;
  if (is_plane_) return;
  const Vec3 of_plane = normal_;
  normal_ = mean;
  along_ = normal_.unitOrthogonal();
  beside_ = normal_.cross(along_);
  Points local(samples_.rows(), 3);
  local << centered * along_, centered * beside_, centered * normal_;
  try {
    field_ = std::make_shared<Field>(PlanePoints(local.leftCols(2)), local, FieldOptions{.unit = edge_});
  } catch (const InvalidArgument&) {  // too few, or on a line
    return;
  }
  noise_ = field_->noise();
  if (noise_ > rough_noise_share * edge_) {
    field_.reset();
    return;
  }
  if (rms < as_noise * noise_) {
    is_plane_ = true;
    normal_ = of_plane;
    field_.reset();
    noise_ = rms;
  }
  tolerance_ = std::max(tolerance_, in_piece * noise_);
}

SmoothPiece::At SmoothPiece::at(const Points& points) const {
  const Points local = points.rowwise() - middle_.transpose();
  const Index n = points.rows();
  At out{Eigen::VectorXd(n), Points(n, 3)};
  if (is_plane_) {
    out.distance = local * normal_;
    out.normal = normal_.transpose().replicate(n, 1);
    return out;
  }
  Points rows = Points::Zero(n, 3);
  rows << local * along_, local * beside_, Eigen::VectorXd::Zero(n);
  std::vector<double> jets(static_cast<std::size_t>(9 * n));
  field_->evaluate(rows.data(), n, 1, jets.data());
  for (Index k = 0; k < n; ++k) {
    const double* jet = &jets[static_cast<std::size_t>(9 * k)];
    const Vec3 gradient = normal_ - jet[5] * along_ - jet[8] * beside_;
    out.distance[k] = (Vec3(local.row(k)).dot(normal_) - jet[2]) / gradient.norm();
    out.normal.row(k) = gradient.normalized();
  }
  return out;
}

Eigen::VectorXd SmoothPiece::deviation(const Points& points) const {
  if (is_plane_)
    return Eigen::VectorXd::Constant(points.rows(), noise_ / std::sqrt(std::max(static_cast<double>(samples_.rows()), 1.0)));
  const Points local = points.rowwise() - middle_.transpose();
  PlanePoints places(points.rows(), 2);
  places << local * along_, local * beside_;
  Points up = Points::Zero(points.rows(), 3);
  up.col(2).setOnes();
  const At here = at(points);
  return field_->deviation(places, up).cwiseProduct((here.normal * normal_).cwiseAbs());
}

PlanePoints SmoothPiece::in_plane(const Points& points) const {
  const Vec3 along = is_plane_ ? normal_.unitOrthogonal() : along_, beside = normal_.cross(along);
  PlanePoints out(points.rows(), 2);
  out << (points.rowwise() - middle_.transpose()) * along, (points.rowwise() - middle_.transpose()) * beside;
  return out;
}

namespace {

bool lies_in_piece(const SmoothPiece& plane, const SmoothPiece& other) {
  const double within = std::max(plane.tolerance(), other.tolerance());
  return plane.at(other.samples()).distance.cwiseAbs().maxCoeff() < within;
}

bool are_one_plane(const SmoothPiece& a, const SmoothPiece& b) {
  return a.is_plane() && b.is_plane() && angle_between(a.normal(), b.normal()) < one_plane && lies_in_piece(a, b) &&
         lies_in_piece(b, a);
}

/// Faces near a hole, by piece.
class PieceGrowth {
public:
  PieceGrowth(const Mesh& mesh, const Connectivity& around, const IsSharp& is_sharp, const std::vector<Index>& near)
      : mesh_(mesh), around_(around), is_sharp_(is_sharp), near_(near), seen_(mesh.faces.size()) {}

  /// The piece of a face.
  std::size_t piece_of(Index face) {
    if (!seen_.add(face)) return piece_[static_cast<std::size_t>(seen_.find(face))];
    piece_.push_back(faces.size());
    faces.emplace_back();
    std::deque<Index> open = {face};
    while (!open.empty()) {
      const Index f = open.front();
      open.pop_front();
      faces.back().push_back(f);
      const auto corners = mesh_.faces[f];
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const Index a = corners[k], b = corners[(k + 1) % corners.size()];
        const auto beyond = is_sharp_(a, b) ? std::nullopt : around_.edge(b, a);
        if (!beyond || !is_near(around_.face(*beyond)) || !seen_.add(around_.face(*beyond))) continue;
        piece_.push_back(faces.size() - 1);
        open.push_back(around_.face(*beyond));
      }
    }
    return faces.size() - 1;
  }

  std::vector<std::vector<Index>> faces;

private:
  bool is_near(Index face) const {
    const auto corners = mesh_.faces[face];
    return std::all_of(corners.begin(), corners.end(),
                       [&](Index v) { return std::binary_search(near_.begin(), near_.end(), v); });
  }

  const Mesh& mesh_;
  const Connectivity& around_;
  const IsSharp& is_sharp_;
  const std::vector<Index>& near_;
  Numbering seen_;
  std::vector<std::size_t> piece_;
};

}  // namespace

PiecesFound smooth_pieces(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, const IsSharp& is_sharp,
                          const std::vector<Index>& near, double across) {
  PieceGrowth growth(mesh, around, is_sharp, near);
  PiecesFound found;
  for (std::size_t k = 0; k < rim.size(); ++k) {
    const auto corner = around.edge(rim[(k + 1) % rim.size()], rim[k]);
    if (!corner) return {};
    found.beside.push_back(growth.piece_of(around.face(*corner)));
  }
  for (const Index v : rim)
    for (const Connectivity::Corner c : around.at(v)) growth.piece_of(around.face(c));
  const Points points = mesh.vertices(rim, Eigen::all);
  std::vector<std::size_t> number;  // of pieces, once those of one plane are one
  std::vector<std::vector<Index>> faces;
  std::vector<SmoothPiece> pieces;
  for (const std::vector<Index>& own : growth.faces) {
    SmoothPiece piece(mesh, own, points, across);
    const auto same = std::ranges::find_if(pieces, [&](const SmoothPiece& p) { return are_one_plane(p, piece); });
    number.push_back(static_cast<std::size_t>(same - pieces.begin()));
    if (same == pieces.end()) {
      pieces.push_back(std::move(piece));
      continue;
    }
    std::vector<Index> both = same->faces();
    both.insert(both.end(), own.begin(), own.end());
    *same = SmoothPiece(mesh, both, points, across);
  }
  for (std::size_t& piece : found.beside) piece = number[piece];
  for (std::size_t k = 0; k < growth.faces.size(); ++k)
    for (const Index f : growth.faces[k]) found.of_face[f] = number[k];
  found.pieces = std::move(pieces);
  return found;
}

}  // namespace tripatch
