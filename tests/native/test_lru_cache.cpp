#include <catch2/catch.hpp>
#include <memory>

#include "tripatch/math/lru_cache.h"

using namespace tripatch;

namespace {

Key key_of(double number) {
  Key key;
  key.add(number);
  return key;
}

}  // namespace

TEST_CASE("What is asked for again is kept while others come and go", "[kept]") {
  LruCache<double> last(3);
  last.keep(key_of(0), std::make_shared<const double>(0.5));
  for (int k = 1; k < 10; ++k) {
    REQUIRE(last.find(key_of(0)));
    CHECK(*last.find(key_of(0)) == 0.5);
    last.keep(key_of(k), std::make_shared<const double>(k));
  }
  CHECK(last.find(key_of(9)));
  CHECK_FALSE(last.find(key_of(1)));
}

TEST_CASE("What nobody asks for goes first", "[kept]") {
  LruCache<double> last(2);
  for (int k = 0; k < 3; ++k) last.keep(key_of(k), std::make_shared<const double>(k));
  CHECK_FALSE(last.find(key_of(0)));
  CHECK(*last.find(key_of(1)) == 1);
  last.keep(key_of(3), std::make_shared<const double>(3));
  CHECK_FALSE(last.find(key_of(2)));
  CHECK(*last.find(key_of(1)) == 1);
}
