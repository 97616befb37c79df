// Which of several fills of a hole is used, and what is listed of the others.
#include <catch2/catch.hpp>
#include <limits>

#include "test_refusals.h"
#include "tripatch/constructions/methods.h"
#include "tripatch/fill/select.h"
#include "tripatch/spline/plane_patch.h"

using namespace tripatch;

namespace {

Quality with_error(double error) {
  Quality quality;
  quality.expected_error = error;
  return quality;
}

/// A candidate that is made.
Tried made(const std::string& method, const Quality& quality) {
  Tried out;
  out.row = {method, CandidateStatus::made, quality, {}};
  out.fill.emplace();
  out.fill->report.method = method;
  out.fill->report.method_reason = Message{Code::requested, {{"method", method}}};
  return out;
}

/// A patch of such an energy whose tangent planes are known to so many degrees.
Fill patch(double energy, double planes) {
  Fill fill;
  fill.vertices = Points::Zero(1, 3);
  fill.patch = std::make_shared<PlanePatch>(nullptr, PlanePoints(0, 2));
  fill.report.method = patch_method;
  fill.report.energy_after = energy;
  fill.report.surroundings_error = planes;
  return fill;
}

}  // namespace

TEST_CASE("crossings count before folds, folds before leaving the hole, and that before errors") {
  Quality crosses = with_error(0), folds = with_error(1), leaves = with_error(2);
  crosses.crosses = leaves.exceeds_hole_bounds = true;
  folds.folds = 1;
  const Quality valid = with_error(3);
  CHECK((is_better(valid, leaves) && is_better(leaves, folds) && is_better(folds, crosses)));
  CHECK((!is_better(leaves, valid) && !is_better(folds, leaves) && !is_better(crosses, folds)));
  CHECK(is_better(with_error(1), with_error(2)));
  CHECK((is_valid(valid) && !is_valid(leaves) && !is_valid(folds) && !is_valid(crosses)));
}

TEST_CASE("errors that differ by rounding only -> the first candidate is used") {
  TriedFills tried;
  tried.push_back(made("first", with_error(1)));
  tried.push_back(made("second", with_error(1 - 1e-12)));
  CHECK(selected(std::move(tried)).report.method == "first");
}

TEST_CASE("the report lists all candidates, the used one first, skipped and refused ones last") {
  TriedFills tried(2);
  tried[0].row = {"skipped", CandidateStatus::skipped, {}, Message{Code::not_among_quads}};
  tried[0].variant = Code::flat_wall;
  tried[1].row = {"refused", CandidateStatus::refused, {}, Message{Code::not_made, {{"reason", Message{Code::rim_on_borders}}}}};
  tried.push_back(made("worse", with_error(2)));
  tried.push_back(made("best", with_error(1)));
  const std::vector<FillCandidate> rows = selected(std::move(tried)).report.candidates;
  REQUIRE(rows.size() == 4);
  CHECK((rows[0].method == "best" && rows[0].status == CandidateStatus::used && rows[0].why->code == Code::requested));
  CHECK((rows[1].method == "worse" && rows[1].why->code == Code::less_accurate));
  CHECK((rows[2].method == "skipped" && rows[2].why->text() == "as a flat wall: the faces around the hole are not quads"));
  CHECK((rows[3].method == "refused" && rows[3].why->code == Code::not_made));
}

TEST_CASE("a fill without faces is used only if no other was made") {
  Quality crosses = with_error(1);
  crosses.crosses = true;
  TriedFills tried;
  tried.push_back(made("without faces", with_error(0)));
  tried.push_back(made("crossing", crosses));
  tried.back().fill->faces.offsets = {0, 3};
  tried.back().fill->faces.corners = {0, 1, 2};
  CHECK(selected(std::move(tried)).report.method == "crossing");
}

TEST_CASE("if every candidate refuses, the last refusal is thrown") {
  TriedFills tried(2);
  tried[0].refusal.emplace(Code::no_border);
  tried[1].refusal.emplace(Code::rim_too_short);
  CHECK(refusal_code([&] { selected(std::move(tried)); }) == "rim_too_short");
}

TEST_CASE("the expected error of a patch grows with its energy and the error of the tangent planes, and with the hole") {
  CHECK(expected_error(patch(0, 0), 1) == 0);
  CHECK(expected_error(patch(2, 0), 1) > expected_error(patch(1, 0), 1));
  CHECK(expected_error(patch(1, 2), 1) > expected_error(patch(1, 1), 1));
  CHECK(expected_error(patch(1, 1), 2) == Approx(2 * expected_error(patch(1, 1), 1)));
}

TEST_CASE("nothing is expected to be farther off than the hole is large") {
  CHECK(expected_error(patch(1e12, 0), 3) == 3);
  CHECK(expected_error(patch(std::numeric_limits<double>::quiet_NaN(), 0), 3) == 3);
}

TEST_CASE("a patch that bends beyond measure is expected to be less accurate than plain triangles") {
  Fill plain;
  plain.report.method = spline_method;
  CHECK(expected_error(plain, 3) < expected_error(patch(1e9, 0), 3));
  CHECK(expected_error(plain, 3) > expected_error(patch(1, 1), 3));
}

TEST_CASE("a spline that states larger deviations is expected to be less accurate") {
  const auto spline = [](double deviation) {
    Fill fill = patch(0, 0);
    fill.report.method = spline_method;
    fill.deviation = Eigen::VectorXd::Constant(4, deviation);
    return expected_error(fill, 1);
  };
  CHECK(spline(0.02) == Approx(2 * spline(0.01)));
}
