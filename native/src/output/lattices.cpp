// Where a resolution asks for many triangles, remeshing all of them takes most of the time, and what it makes of sizes that hardly change is
// close to a lattice. So the mesh is made coarse, each of its triangles far from the rim is cut in rows, and the band in between remeshed.
#include <Eigen/Geometry>
#include <algorithm>

#include "tripatch/math/interruption.h"
#include "tripatch/output/domain_mesh.h"

namespace tripatch {

bool DomainMesh::take_lattices_out() {
  if (rows_ == 1) return false;
  std::vector<char> far(b_.size(), 1);
  const auto look = [&] {
    limit_sizes();
    for (int v = 0; v < static_cast<int>(far.size()); ++v)
      far[v] = far[v] && triangle_of_[v] >= 0 && !is_fixed(v) && size_[v] == wanted(b_[v]);
  };
  look();
  coarser_ /= rows_;
  look();
  for (const Triangle& f : triangles_)
    if (f.v[0] >= 0 && shape_of(f.v[0], f.v[1], f.v[2]) < lattice_shape)
      for (int v : f.v) far[v] = 0;
  std::vector<int> kept(triangles_.size(), at_lattice);
  std::vector<Triangle> band;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const std::array<int, 3>& v = triangles_[t].v;
    if (v[0] < 0) continue;
    if (far[v[0]] && far[v[1]] && far[v[2]]) {
      lattices_.push_back(v);
      for (int corner : v) on_lattice_[corner] = 1;
    } else {
      kept[t] = static_cast<int>(band.size());
      band.push_back(triangles_[t]);
    }
  }
  triangles_ = std::move(band);
  std::fill(triangle_of_.begin(), triangle_of_.end(), -1);
  for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
    for (int v : triangles_[t].v) triangle_of_[v] = t;
    for (int& n : triangles_[t].n)
      if (n >= 0) n = kept[n];
  }
  ring_of_ = -1;
  most_ = rows_ * rows_ * (most_ - static_cast<double>(lattices_.size()));
  cut_edges_of_lattices();
  return true;
}

void DomainMesh::cut_edges_of_lattices() {
  const int corners = static_cast<int>(b_.size());
  std::vector<Vec3> places;
  for (const std::array<int, 3>& v : lattices_)
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(v[k], v[(k + 1) % 3]);
      if (!first_on_edge_.try_emplace({a, b}, corners + static_cast<int>(places.size())).second) continue;
      for (int row = 1; row < rows_; ++row) {
        const double f = static_cast<double>(row) / rows_;
        places.emplace_back((1 - f) * b_[a] + f * b_[b]);
      }
    }
  const Points x = positions(places);
  for (std::size_t k = 0; k < places.size(); ++k) on_lattice_[add_vertex(places[k], x.row(static_cast<Index>(k)))] = 1;
  for (int t = 0; t < static_cast<int>(triangles_.size()); ++t)  // those that this makes too
    for (int k = 0; k < 3; ++k) {
      const int from = triangles_[t].v[(k + 1) % 3], to = triangles_[t].v[(k + 2) % 3];
      if (triangles_[t].n[k] != at_lattice || from >= corners || to >= corners) continue;
      for (int row = rows_ - 1; row > 0; --row) split_edge(t, k, on_lattice_edge(from, to, row));
    }
}

int DomainMesh::on_lattice_edge(int from, int to, int row) const {
  if (row == 0) return from;
  if (row == rows_) return to;
  const auto [a, b] = std::minmax(from, to);
  return first_on_edge_.at({a, b}) + (from == a ? row : rows_ - row) - 1;
}

void DomainMesh::add_lattices() {
  std::vector<Vec3> places;
  for (const std::array<int, 3>& v : lattices_)
    for (int q = 1; q < rows_; ++q)
      for (int p = 1; p + q < rows_; ++p) places.emplace_back(((rows_ - p - q) * b_[v[0]] + p * b_[v[1]] + q * b_[v[2]]) / rows_);
  const Points x = positions(places);
  int inside = static_cast<int>(b_.size());
  for (std::size_t k = 0; k < places.size(); ++k) add_vertex(places[k], x.row(static_cast<Index>(k)));
  const auto add = [&](const std::array<int, 3>& v) {
    for (int corner : v) triangle_of_[corner] = static_cast<int>(triangles_.size());
    triangles_.push_back({v, {at_lattice, at_lattice, at_lattice}});
  };
  std::vector<int> row, next;  // vertices
  for (const std::array<int, 3>& v : lattices_) {
    check_interruption();
    next.clear();
    for (int p = 0; p <= rows_; ++p) next.push_back(on_lattice_edge(v[0], v[1], p));
    for (int q = 1; q <= rows_; ++q) {
      row.swap(next);
      next = {on_lattice_edge(v[0], v[2], q)};
      for (int p = 1; p + q < rows_; ++p) next.push_back(inside++);
      if (q < rows_) next.push_back(on_lattice_edge(v[1], v[2], q));
      for (int p = 0; p + q <= rows_; ++p) {
        add({row[p], row[p + 1], next[p]});
        if (p + q < rows_) add({row[p + 1], next[p + 1], next[p]});
      }
    }
  }
}

}  // namespace tripatch
