#include "test_surfaces.h"
#include "tripatch/constructions/quintic.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

SurfacePtr make(const Sides& sides) { return quintic(make_boundary(sides)); }

}  // namespace

TEST_CASE("quintic keeps its promises") { check_promises(make, 1); }

TEST_CASE("quintic reproduces polynomials of degree 5, and no more") {
  for (int degree = 1; degree <= 5; ++degree) CHECK(reproduction_error(make, degree) < 1e-12);
  CHECK(reproduction_error(make, 6) > 1e-3);
}

TEST_CASE("the basic operator alone is the quintic that the data come from") {
  const Points net = random_net(5, 9);
  CHECK((quintic_net(make_boundary(sides_of(bezier(net)))) - net).cwiseAbs().maxCoeff() < 1e-12);
}
