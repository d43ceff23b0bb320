// View files read back as they were written, and what is none is refused with its line.
#include "formats/plan/view.h"

#include <gtest/gtest.h>

#include "formats/error.h"
#include "tests/formats/files.h"

namespace tempolux::formats {
namespace {

TEST(View, ReadsBackToTheSameBits) {
  const View view{{{{0.5, -1.5, 3e-7}, 0.875, 0.0625}, {{1e20, 0.1, -0.0}, 1.0 / 3, 1}},
                  {{{0.1, 0, 2}, 1e-9, 0.7}},
                  {{0, 0.1}, {7, 1e-7}, {ViewLight::kEnvironment, 0.5}}};
  const std::string text = view_text(view);
  const View read = parse_view(text, "view");
  ASSERT_EQ(read.spheres.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read.spheres[i].centre, view.spheres[i].centre);
    EXPECT_EQ(read.spheres[i].radius, view.spheres[i].radius);
    EXPECT_EQ(read.spheres[i].weight, view.spheres[i].weight);
  }
  ASSERT_EQ(read.openings.size(), 1u);
  EXPECT_EQ(read.openings[0].centre, view.openings[0].centre);
  EXPECT_EQ(read.openings[0].radius, view.openings[0].radius);
  EXPECT_EQ(read.openings[0].weight, view.openings[0].weight);
  ASSERT_EQ(read.lights.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(read.lights[i].node, view.lights[i].node);
    EXPECT_EQ(read.lights[i].share, view.lights[i].share);
  }
  EXPECT_EQ(view_text(read), text);
}

// Without lights and openings a view is what version 1.0 was, byte by byte; without openings what 1.1 was.
TEST(View, IsOfTheFirstVersionThatHasItsLines) {
  EXPECT_EQ(view_text({{}, {}, {{3, 1}}}), "tempolux view 1.1\nlight 3 1\n");
  EXPECT_EQ(view_text({}), "tempolux view 1.0\n");
  EXPECT_TRUE(parse_view(view_text({}), "view").spheres.empty());
}

TEST(View, WorkedExampleOfThePageIsWhatTheWriterWrites) {
  View view;
  view.spheres = {{{1, 1, -1}, 1.75, 0.5}, {{3, 1, -1}, 1.75, 0.25}};
  view.openings = {{{4.5, 1.5, -1.5}, 0.4375, 0.5}};
  view.lights = {{12, 0.5}, {ViewLight::kEnvironment, 0.25}};
  const std::string text = view_text(view);
  EXPECT_NE(testing::load("../formats/plan/plan.md").find("\n\n" + testing::as_on_a_page(text) + "\n"),
            std::string::npos)
      << text;
}

TEST(View, RefusesWhatIsNone) {
  const std::string first = "tempolux view 1.0\n", good = "0 0 0 1 1\n", second = "tempolux view 1.1\n",
                    third = "tempolux view 1.2\n";
  std::string many = first, lights = second, openings = third;
  for (std::size_t i = 0; i <= kMaxViewSpheres; ++i) many += good, openings += "opening " + good;
  for (std::size_t i = 0; i <= kMaxViewLights; ++i) lights += "light 1 1\n";
  for (const auto& [text, line] : {std::pair<std::string, const char*>{"", "line 1"},
                                   {"tempolux view 2.0\n", "line 1"},
                                   {first + "\n", "line 2"},
                                   {first + good + "0 0 0 1\n", "line 3"},
                                   {first + "0 0 0 1 1 1\n", "line 2"},
                                   {first + "0 0 nan 1 1\n", "line 2"},
                                   {first + "inf 0 0 1 1\n", "line 2"},
                                   {first + "0 0 0 0 1\n", "line 2"},
                                   {first + "0 0 0 1 -1\n", "line 2"},
                                   {first + "0 0 0 1e31 1\n", "line 2"},
                                   {first + "0 0 0 one 1\n", "line 2"},
                                   {first + "light 1 1\n", "line 2"},
                                   {second + "light 1\n", "line 2"},
                                   {second + "light 1 0\n", "line 2"},
                                   {second + "light 1 nan\n", "line 2"},
                                   {second + "light -1 1\n", "line 2"},
                                   {second + "light 4294967295 1\n", "line 2"},
                                   {second + "light sun 1\n", "line 2"},
                                   {second + "light environment 1 1\n", "line 2"},
                                   {second + "opening 0 0 0 1 1\n", "line 2"},
                                   {third + good + "opening 0 0 0 1\n", "line 3"},
                                   {third + "opening 0 0 0 0 1\n", "line 2"},
                                   {third + "opening\n", "line 2"},
                                   {openings, "line 34"},
                                   {lights, "line 66"},
                                   {many, "line 34"}}) {
    try {
      parse_view(text, "view");
      ADD_FAILURE() << "accepted: " << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(line), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace tempolux::formats
