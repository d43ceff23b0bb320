// Names of objects in a frame: all names are read as they were written, whatever they contain; lines of other
// programs are skipped.
#include "lib/image/object_names.h"

#include <gtest/gtest.h>

namespace tempolux {
namespace {

Image frame(const std::string& attribute) {
  Image image;
  image.text["tempolux:objects"] = attribute;
  return image;
}

TEST(ObjectNames, AreThoseOfTheIds) {
  Image image;
  set_object_names(image, {2, 0, 7, 0xffffffffu}, {"Sofa", "Table", "Lamp 2 \xc3\xa4", "Door"});
  EXPECT_EQ(image.text["tempolux:objects"], "0 Sofa\n2 Lamp 2 \xc3\xa4\n");  // 7 and "nothing" have no name
  EXPECT_EQ(object_names_in(image), (ObjectNames{{0, "Sofa"}, {2, "Lamp 2 \xc3\xa4"}}));
}

TEST(ObjectNames, ANameIsOneLine) {
  Image image;
  set_object_names(image, {0}, {"Sofa\n1 Table\x7f"});
  EXPECT_EQ(object_names_in(image), (ObjectNames{{0, "Sofa 1 Table "}}));
}

TEST(ObjectNames, WithoutNamesThereIsNoAttribute) {
  Image image;
  set_object_names(image, {0, 1}, {"", ""});
  EXPECT_TRUE(image.text.empty());
  EXPECT_TRUE(object_names_in(image).empty());
}

TEST(ObjectNames, OtherLinesAreLeftOut) {
  EXPECT_EQ(object_names_in(frame("x\n5\n6 \n-1 A\n4294967296 B\n3 C")), (ObjectNames{{3, "C"}}));
}

TEST(ObjectNames, InWords) {
  EXPECT_EQ(object_in_words(3, {{3, "C"}}), "\"C\"");
  EXPECT_EQ(object_in_words(4, {{3, "C"}}), "object 4");
}

}  // namespace
}  // namespace tempolux
