// View files read back as they were written, and what is none is refused with its line.
#include "formats/plan/view.h"

#include <gtest/gtest.h>

#include "formats/error.h"
#include "tests/formats/files.h"

namespace tempolux::formats {
namespace {

TEST(View, ReadsBackToTheSameBits) {
  const std::vector<ViewSphere> spheres = {{{0.5, -1.5, 3e-7}, 0.875, 0.0625}, {{1e20, 0.1, -0.0}, 1.0 / 3, 1}};
  const std::string text = view_text(spheres);
  const std::vector<ViewSphere> read = parse_view(text, "view");
  ASSERT_EQ(read.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read[i].centre, spheres[i].centre);
    EXPECT_EQ(read[i].radius, spheres[i].radius);
    EXPECT_EQ(read[i].weight, spheres[i].weight);
  }
  EXPECT_EQ(view_text(read), text);
  EXPECT_TRUE(parse_view(view_text({}), "view").empty());
}

TEST(View, WorkedExampleOfThePageIsWhatTheWriterWrites) {
  const std::string text = view_text(std::vector<ViewSphere>{{{1, 1, -1}, 1.75, 0.5}, {{3, 1, -1}, 1.75, 0.25}});
  EXPECT_NE(testing::load("../formats/plan/plan.md").find("\n\n" + testing::as_on_a_page(text) + "\n"),
            std::string::npos)
      << text;
}

TEST(View, RefusesWhatIsNone) {
  const std::string first = "tempolux view 1.0\n", good = "0 0 0 1 1\n";
  std::string many = first;
  for (std::size_t i = 0; i <= kMaxViewSpheres; ++i) many += good;
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
