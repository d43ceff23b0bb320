// tests/lib/report/comparison_test.cpp -- the JSON of comparison.md, and what the report reads of it.
#include "lib/report/comparison.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "formats/error.h"
#include "lib/report/report_input.h"
#include "tests/lib/aqm/synthetic.h"

namespace tempolux {
namespace {

using nlohmann::json;
using namespace synthetic;

Comparison example() {
  Comparison comparison;
  comparison.command = "aqm-compare 0.1.0 x.exr r.exr";
  comparison.test = "x.exr";
  comparison.references = {"r.exr"};
  ComparisonBuilder builder(comparison);
  const Image x = constant_image(32, 16, 0.75), r = constant_image(32, 16, 0.5);
  builder.add(compare(x, r), 0, "x.exr");
  return builder.finish();
}

/// The first ```json block of a page of formats.
json example_of_page(const std::string& path) {
  std::ifstream file(path);
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  const std::size_t begin = page.find("```json\n") + 8;
  return json::parse(page.substr(begin, page.find("```", begin) - begin));
}

/// Expects that `whole` contains `part`: every key of each object, every element of each array; numbers to 1e-12.
void expect_contains(const json& whole, const json& part, const std::string& where) {
  if (part.is_object()) {
    for (const auto& [key, value] : part.items()) {
      ASSERT_TRUE(whole.contains(key)) << where << "." << key;
      expect_contains(whole[key], value, where + "." + key);
    }
  } else if (part.is_array()) {
    ASSERT_EQ(whole.size(), part.size()) << where;
    for (std::size_t i = 0; i < part.size(); ++i) expect_contains(whole[i], part[i], where + "[]");
  } else if (part.is_number()) {
    EXPECT_NEAR(whole.get<double>(), part.get<double>(), 1e-12) << where;
  } else {
    EXPECT_EQ(whole, part) << where;
  }
}

std::string temporary(const std::string& name, const std::string& content) {
  const std::string path = testing::TempDir() + "tempolux_comparison_test_" + name;
  std::ofstream(path) << content;
  return path;
}

std::string refusal(const std::string& content) {
  const std::string path = temporary("refused.json", content);
  try {
    read_comparison(path);
  } catch (const InputError& error) { return std::string(error.what()).substr(path.size()); }
  return "accepted";
}

// The tests run in tests/.
TEST(ComparisonTest, WorkedExampleOfThePageIsWhatIsWritten) {
  const json page = example_of_page("../formats/comparison/comparison.md");
  const json written = json::parse(comparison_json(example()));
  expect_contains(written, page, "");
  EXPECT_EQ(written["total"].size(), page["total"].size());  // nothing that the page leaves out
}

TEST(ComparisonTest, WhatIsWrittenIsReadBack) {
  const ErrorRecord record = read_comparison(temporary("good.json", comparison_json(example())));
  EXPECT_DOUBLE_EQ(record.mse, 0.0625);
  EXPECT_DOUBLE_EQ(record.rmse(), 0.25);
  EXPECT_FALSE(record.halves);
  EXPECT_TRUE(record.usable());
  EXPECT_FALSE(record.flicker);
}

TEST(ComparisonTest, FiguresThatDoNotExistAreNullNeverNan) {
  Comparison comparison;
  comparison.references = {"r"};
  ComparisonBuilder builder(comparison);
  const Image black = constant_image(1, 1, 0);
  builder.add(compare(black, black), 0, "x");
  builder.add(compare(black, black), 1, "x");
  const Comparison result = builder.finish();
  const std::string text = comparison_json(result);
  const json total = json::parse(text)["total"];
  for (const char* key : {"relmse", "bias", "psnr_db", "mse_standard_error", "rmse_standard_error"})
    EXPECT_TRUE(total[key].is_null()) << key;
  EXPECT_EQ(total["flicker"], 0.0);
  EXPECT_EQ(comparison_text(result).find("nan"), std::string::npos);
  EXPECT_EQ(comparison_text(result).find("inf"), std::string::npos);
}

TEST(ComparisonTest, TextSaysWhatMustNotBeQuoted) {
  const Image x = constant_image(64, 64, 1);
  int negative = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Image r1 = noisy_image(64, 64, 1, 0.1, 2 * seed), r2 = noisy_image(64, 64, 1, 0.1, 2 * seed + 1);
    Comparison comparison;
    comparison.references = {"r1", "r2"};
    comparison.mode = ComparisonMode::reference_halves;
    ComparisonBuilder builder(comparison);
    builder.add(compare(x, r1, &r2), 0, "x");
    const Comparison result = builder.finish();
    const bool below = result.total.squared_error.squared.value < 0;
    negative += below;
    EXPECT_EQ(comparison_text(result).find("below what the reference resolves") != std::string::npos, below);
  }
  EXPECT_GT(negative, 0);
}

TEST(ComparisonTest, ReaderRefusesWhatIsNotAComparison) {
  EXPECT_EQ(refusal("{"), ": byte 2: not JSON; make it anew");
  EXPECT_EQ(refusal("[]"), ": not a tempolux.comparison file: its \"schema\" is another");
  EXPECT_EQ(refusal(R"({"schema": "tempolux.stats", "version": "1.0"})"),
            ": not a tempolux.comparison file: its \"schema\" is another");
  EXPECT_EQ(refusal(R"({"schema": "tempolux.comparison", "version": "2.0"})"),
            ": version \"2.0\" of tempolux.comparison; this program reads 1.x");
  EXPECT_EQ(refusal(R"({"schema": "tempolux.comparison", "version": "1.0"})"), ": has no \"total\"");
  json document = json::parse(comparison_json(example()));
  document["total"]["mse"] = "much";
  EXPECT_EQ(refusal(document.dump()), ": total.mse: not a finite number");
  document["total"]["mse"] = 1;
  document["mode"] = "own_halves";
  EXPECT_EQ(refusal(document.dump()), ": compares two halves of one image: its noise, not its error");
  EXPECT_EQ(refusal(std::string(200000, '[')), ": nested deeper than 32 levels; this is no file of ours");
}

}  // namespace
}  // namespace tempolux
