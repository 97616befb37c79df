// The table of options: what it says of its rows, and what it lets through.
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "tripatch/options.h"

using namespace tripatch;

namespace {

const Option& option(const std::string& name) {
  for (const Option& each : options())
    if (each.name == name) return each;
  FAIL("no option " << name);
  return options()[0];
}

std::string refused(const FillOptions& given) {
  try {
    check(given);
  } catch (const InvalidArgument& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("every option has a name of its own and a sentence, and reads others that exist") {
  std::set<std::string> names;
  for (const Option& each : options()) CHECK(names.insert(each.name).second);
  for (const Option& each : options()) {
    INFO(each.name);
    CHECK(std::string(each.sentence).size() > 10);
    CHECK(std::string(each.sentence).back() != '.');
    for (const Condition& condition : each.applies) CHECK(names.contains(condition.option));
  }
}

TEST_CASE("what an option is follows from its type") {
  CHECK(option("tension").kind == Option::Kind::number);
  CHECK(!option("tension").optional);
  CHECK(option("shape").by_side);
  CHECK(option("shape").optional);
  CHECK(option("pole_offset").count == 2);
  CHECK(option("symmetric").kind == Option::Kind::flag);
  CHECK(option("fairing").choices.size() == choices<Fairing>.size());
  CHECK(option("alpha").applies.size() == 1);  // coons_bezier alone names it
}

TEST_CASE("the defaults are in their ranges") { CHECK(refused({}).empty()); }

TEST_CASE("numbers out of their ranges are refused by the name of their option") {
  FillOptions given;
  given.tension = -1;
  CHECK(refused(given) == "tension must be 0 or more, not -1");
  given = {};
  given.bulge = {1, 0, 1};
  CHECK(refused(given) == "bulge[1] must be greater than 0, not 0");
  given = {};
  given.own.shape = {0.5, 0.5, 1.0};
  CHECK(refused(given) == "shape[2] must be between 0 and 1, ends excluded, not 1");
  given = {};
  given.tolerance = 0;
  CHECK(refused(given) == "tolerance must be greater than 0, not 0");
  given = {};
  given.center = Vec3(0, NAN, 0);
  CHECK(refused(given) == "center[1] is not finite");
  given = {};
  given.own.shape.reset();
  CHECK(refused(given).empty());
}

TEST_CASE("choices have names") {
  CHECK(std::string(name_of(SideContinuity::g2)) == "G2");
  CHECK(named<Odd>("triangle", "odd") == Odd::triangle);
  CHECK_THROWS_WITH(named<Odd>("both", "odd"), "odd must be one of split, triangle, not 'both'");
}
