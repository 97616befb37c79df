// What a fuzzer's bytes mean: numbers, and meshes from plausible to absurd. Where they end, all further ones are 0.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <vector>

#include "tripatch/types.h"

namespace tripatch::fuzz {

/// Ends the program where something does not hold: the fuzzer keeps the bytes that led there.
inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "WRONG: %s\n", what);
  std::abort();
}

class Bytes {
public:
  Bytes(const std::uint8_t* data, std::size_t size) : at_(data), end_(data + size) {}

  std::uint8_t byte() { return at_ < end_ ? *at_++ : 0; }
  bool flag() { return (byte() & 1) != 0; }
  /// One time in `times`.
  bool seldom(int times) { return byte() % times == 1; }
  /// Both ends included, at most 2^16 apart.
  int whole(int least, int most) { return least + (byte() | byte() << 8) % (most - least + 1); }
  /// Of all doubles, mostly small ones of few digits.
  double number();
  Vec3 point() {
    const double x = number(), y = number(), z = number();
    return {x, y, z};
  }
  std::vector<Index> indices(int most_of_them, Index most);

private:
  const std::uint8_t *at_, *end_;
};

inline double Bytes::number() {
  constexpr double largest = std::numeric_limits<double>::max(), inf = std::numeric_limits<double>::infinity();
  constexpr std::array<double, 16> odd = {
      0.0,  -0.0, 5e-324, 1e-300, 1e-30,   1e-9,     1 + 1e-15, 1e9,
      1e16, 1e30, 1e150,  1e300,  largest, -largest, inf,       std::numeric_limits<double>::quiet_NaN()};
  const std::uint8_t kind = byte();
  if (kind < 160) return static_cast<std::int8_t>(byte()) / 16.0;
  if (kind < 240) return static_cast<std::int16_t>(byte() | byte() << 8) / 4096.0;
  if (kind < 248) return odd[byte() % odd.size()];
  std::uint64_t bits = 0;
  for (int k = 0; k < 8; ++k) bits = bits << 8 | byte();
  return std::bit_cast<double>(bits);
}

inline std::vector<Index> Bytes::indices(int most_of_them, Index most) {
  std::vector<Index> found(byte() % (most_of_them + 1));
  for (Index& v : found) v = most < 0 ? 0 : byte() % (most + 1);
  return found;
}

struct OwnMesh {
  Points vertices = Points(0, 3);
  Faces faces;

  operator Mesh() const { return {vertices, faces}; }  // NOLINT(google-explicit-constructor): as of a vector to a span
};

/// n x m quads over a square, each cut in two where asked for, or closed to a torus.
OwnMesh grid(int n, int m, bool cut, bool closed);
/// An octahedron with every triangle cut in four so many times, on the sphere.
OwnMesh ball(int times);
/// One of these with faces taken out and vertices moved; or vertices and faces from the bytes alone.
OwnMesh take_mesh(Bytes& bytes);

}  // namespace tripatch::fuzz
