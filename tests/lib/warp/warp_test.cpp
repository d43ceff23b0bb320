// Frames warped from painted keys: what must come out is known for every pixel.
#include "tests/lib/warp/warp_fixture.h"

namespace tempolux::test {
namespace {

using formats::why_border, formats::why_changed_light, formats::why_edge, formats::why_occlusion, formats::why_specular,
    formats::why_undersampled;

const PlacedCamera kMiddle = camera_at({0, 1, 1.9});

/// Neighbouring pixels have very different colours, so any interpolation shows.
Rgb speckled(Vec3d p, std::uint32_t object) {
  return {float(std::sin(900 * p.x) + 2), float(std::sin(700 * p.y) + 2), float(object) + float(std::sin(800 * p.z))};
}

TEST(Warp, ToItsOwnFrameIsTheSameToTheBit) {
  const Cornell room;
  const View view(room, kMiddle);
  const Image key = painted(view, speckled);
  const Warped warped(view, {{view, key, 0}});
  for (std::size_t p = 0; p < key.pixel_count(); ++p) {
    ASSERT_EQ(warped.colour(p), (Rgb{key.find("R")->values[p], key.find("G")->values[p], key.find("B")->values[p]}))
        << p;
    ASSERT_EQ(warped.frame.why[p], 0u);
  }
}

/// A key of another program has no object numbers of the scene and filtered normals. Depth and normals separate its
/// surfaces. It contributes nearly all pixels that the same key with objects contributes, and no ghosts: blue is the
/// object's number, and the room's objects differ in depth or normal wherever they meet.
TEST(Warp, KeysThatKnowNoObjectsAreOfUse) {
  const Cornell room;
  const View left(room, camera_at({-0.1, 1, 1.9})), right(room, camera_at({0.1, 1, 1.9}));
  const Image key = painted(left, smooth_paint), truth = painted(right, smooth_paint);
  Image plain = key;
  std::erase_if(plain.channels, [](const Channel& channel) { return channel.name == "id.object"; });
  for (const char* component : {"N.X", "N.Y", "N.Z"})
    for (float& value : plain.find(component)->values) value *= 0.8f;
  const Warped same(left, {{left, plain, 0}});
  for (std::size_t p = 0; p < key.pixel_count(); ++p) ASSERT_EQ(same.frame.why[p], 0u) << p;
  const Warped with(right, {{left, key}}), without(right, {{left, plain}});
  int given = 0, given_without = 0;
  for (std::size_t p = 0; p < truth.pixel_count(); ++p) {
    given += with.frame.why[p] == 0;
    if (without.frame.why[p] != 0) continue;
    ++given_without;
    EXPECT_NEAR(without.colour(p).b, truth.find("B")->values[p], 1e-5) << p;
  }
  EXPECT_GT(given, 5000);
  EXPECT_GE(given_without, given * 99 / 100);
}

/// Two equal keys and a static camera: blending does not change a bit. Where the box moved the key is not used.
TEST(Warp, NoiseOfWhatStandsIsNoDifferenceOfTheKeys) {
  const Cornell room;
  const View view(room, kMiddle);
  const Image one = painted(view, [](Vec3d, std::uint32_t) { return Rgb(1.0f); }),
              other = painted(view, [](Vec3d, std::uint32_t) { return Rgb(1.5f); });
  const Warped warped(view, {{view, one}, {view, other}}, {.slow_deg_per_s = 0, .separate = true});
  for (std::size_t p = 0; p < one.pixel_count(); ++p) {
    ASSERT_EQ(warped.colour(p).r, 1.25f);
    ASSERT_EQ(warped.frame.candidates[0][0][p], warped.frame.candidates[1][0][p]);
  }
}

TEST(Warp, WhatStandsKeepsItsBitsBetweenTwoKeys) {
  const Cornell before(9), now(10), after(11);
  const View a(before, kMiddle), view(now, kMiddle), b(after, kMiddle);
  const auto paint = [](Vec3d p, std::uint32_t object) { return object == 8 ? Rgb(1.0f) : speckled(p, object); };
  const Image key_a = painted(a, paint), key_b = painted(b, paint), truth = painted(view, paint);
  const Warped warped(view, {{a, key_a}, {b, key_b}});
  int still = 0;
  for (std::size_t p = 0; p < truth.pixel_count(); ++p) {
    if (warped.frame.why[p] != 0 || view.seen.seen().object[p] == 8) continue;
    const bool same_in_both = key_a.find("id.object")->ids[p] != 8 && key_b.find("id.object")->ids[p] != 8;
    if (!same_in_both) continue;
    const float found = warped.colour(p).r, expected = truth.find("R")->values[p];
    bool near_the_box = false;
    for (int y = int(p) / 96 - 1; y <= int(p) / 96 + 1; ++y)
      for (int x = int(p) % 96 - 1; x <= int(p) % 96 + 1; ++x)
        if (x >= 0 && y >= 0 && x < 96 && y < 72)
          for (const View* seen : {&a, static_cast<const View*>(&view), &b})
            near_the_box |= seen->seen.seen().object[std::size_t(y * 96 + x)] == 8;
    if (!near_the_box) {
      ++still;
      ASSERT_EQ(found, expected) << p;
    }
  }
  EXPECT_GT(still, 5000);
}

/// The camera halves its distance, so each pixel of the key becomes two in each direction. Every pixel of the wall is
/// filled, and shows the wall's colour at its place. Next to edges the closest of 16 pixels is taken, at most 2
/// pixels away: 2 x .033 m of a colour that changes by .22 per m.
TEST(Warp, NoCracksWhereAKeyIsMagnified) {
  const Cornell room;
  const View far(room, camera_at({0.2, 1.3, 1.9})), near(room, camera_at({0.2, 1.3, 0.4}));
  const Image key = painted(far, smooth_paint), truth = painted(near, smooth_paint);
  const Warped warped(near, {{far, key}}, {.slow_deg_per_s = 0, .most_magnified = 64});
  const std::vector<std::uint8_t> whole = whole_pixels(near.seen.seen(), near.seen.camera());
  int wall = 0, masked = 0;
  for (std::size_t p = 0; p < truth.pixel_count(); ++p) {
    const Vec3d at = world_at(near, p);
    if (std::abs(at.z + 1.4) > 1e-4 || !whole[p] || at.x < 0.3) continue;  // to the right of what may hide it
    ++wall;
    if (warped.frame.why[p] == why_edge) {  // within a pixel of the key from an edge, all around
      ++masked;
      continue;
    }
    EXPECT_EQ(warped.frame.why[p], 0u) << p;
    EXPECT_NEAR(warped.colour(p).r, truth.find("R")->values[p], 0.02) << p;
  }
  EXPECT_GT(wall, 1000);
  EXPECT_LT(masked, wall / 20);
  // 3.3 m against 1.8 m: 3.4 times the area. With a limit of 2 all of it is masked with the cause undersampled.
  const Warped limited(near, {{far, key}}, {.slow_deg_per_s = 0, .most_magnified = 2});
  for (std::size_t p = 0; p < truth.pixel_count(); ++p)
    if (std::abs(world_at(near, p).z + 1.4) < 1e-4 && whole[p] && world_at(near, p).x > 0.3) {
      EXPECT_TRUE(limited.frame.why[p] == why_undersampled || limited.frame.why[p] == why_edge);
    }
}

/// Seen from the side, the tall box uncovers wall that the key does not show. Pixels that are not masked have the
/// colour of their own object: blue is the object's number, and no other object's colour is mixed in, also at edges.
/// Seen to fail: surfaces of key and target not compared.
TEST(Warp, NoGhostsWhereDepthsDisagree) {
  const Cornell room;
  const View left(room, camera_at({-0.4, 1, 1.9})), right(room, camera_at({0.4, 1, 1.9}));
  const Image key = painted(left, smooth_paint), truth = painted(right, smooth_paint);
  const Warped warped(right, {{left, key}});
  const std::vector<std::uint8_t> whole = whole_pixels(right.seen.seen(), right.seen.camera());
  int occluded = 0, outside = 0;
  for (std::size_t p = 0; p < truth.pixel_count(); ++p) {
    occluded += (warped.frame.why[p] & why_occlusion) != 0;
    outside += (warped.frame.why[p] & why_border) != 0;
    if (warped.frame.why[p] != 0) continue;
    EXPECT_TRUE(whole[p]) << p;  // at edges one key alone is not enough
    EXPECT_NEAR(warped.colour(p).b, truth.find("B")->values[p], 1e-5) << p;
    EXPECT_NEAR(warped.colour(p).r, truth.find("R")->values[p], 0.03) << p;
  }
  EXPECT_GT(occluded, 100);
  EXPECT_GT(outside, 300);  // .8 m to the side, of 2.4 m that the wall shows
  // A second key from the other side shows what the first one lacks.
  const View beyond(room, camera_at({0.6, 1, 1.9}));
  const Warped both(right, {{left, key}, {beyond, painted(beyond, smooth_paint)}});
  int left_over = 0;
  for (const std::uint32_t why : both.frame.why) left_over += (why & (why_occlusion | why_border)) != 0;
  EXPECT_LT(left_over, (occluded + outside) / 10);
}

/// An edge pixel is composed from the shares of its surfaces: blue, the object's number, is averaged over 64 x 64
/// positions in the pixel. With eight positions, one in each row and column, the share of a straight edge has an
/// error of at most 1/8.
TEST(Warp, EdgesAreComposedFromWhatLiesBesideThem) {
  const Cornell room;
  const View key_view(room, camera_at({0.02, 1, 1.9})), view(room, kMiddle);
  const View other(room, camera_at({-0.02, 1, 1.9}));
  const Warped warped(view, {{key_view, painted(key_view, smooth_paint)}, {other, painted(other, smooth_paint)}});
  const std::vector<std::uint8_t> whole = whole_pixels(view.seen.seen(), view.seen.camera());
  int edges = 0, masked = 0;
  for (std::size_t p = 0; p < whole.size(); ++p) {
    if (whole[p]) continue;
    ++edges;
    if (warped.frame.why[p] != 0) {
      ++masked;
      continue;
    }
    double mean = 0, low = 99, high = 0;
    for (int i = 0; i < 64; ++i) {
      std::array<RasterPoint, 64> at;
      std::array<FacePoint, 64> points;
      for (int j = 0; j < 64; ++j)
        at[std::size_t(j)] = {double(p % 96) + (i + 0.5) / 64, double(p / 96) + (j + 0.5) / 64};
      view.seen.look(at, points.data());
      for (const FacePoint& point : points) {
        mean += double(point.object) / 4096;
        low = std::min(low, double(point.object));
        high = std::max(high, double(point.object));
      }
    }
    EXPECT_NEAR(warped.colour(p).b, mean, 0.126 * (high - low) + 1e-5) << p;
  }
  EXPECT_GT(edges, 300);
  EXPECT_LT(masked, edges / 2);  // where a shadow, or here another paint, begins at the edge: they are traced
}

/// One object is 30 times as bright as all others. Its edges are sampled at more than eight positions, or masked.
/// Pixels that are not masked have an error of at most edge_share, .05, of their light, at 4 sigma. (With eight
/// positions the error would be 1/8 of 29.)
TEST(Warp, EdgesOfBrightThingsAreKnownFinely) {
  const Cornell room;
  const View key_view(room, camera_at({0.02, 1, 1.9})), view(room, kMiddle), other(room, camera_at({-0.02, 1, 1.9}));
  const auto paint = [](Vec3d, std::uint32_t object) { return Rgb(object == 8 ? 30.0f : 1.0f); };
  const Warped warped(view, {{key_view, painted(key_view, paint)}, {other, painted(other, paint)}});
  const std::vector<std::uint8_t> whole = whole_pixels(view.seen.seen(), view.seen.camera());
  double picture = 0;
  for (std::size_t p = 0; p < whole.size(); ++p) picture += double(warped.colour(p).g) / double(whole.size());
  int believed = 0;
  for (std::size_t p = 0; p < whole.size(); ++p) {
    if (whole[p] || warped.frame.why[p] != 0) continue;
    double mean = 0;
    bool bright = false;
    for (int i = 0; i < 64; ++i) {
      std::array<RasterPoint, 64> at;
      std::array<FacePoint, 64> points;
      for (int j = 0; j < 64; ++j)
        at[std::size_t(j)] = {double(p % 96) + (i + 0.5) / 64, double(p / 96) + (j + 0.5) / 64};
      view.seen.look(at, points.data());
      for (const FacePoint& point : points) {
        mean += (point.object == 8 ? 30.0 : 1.0) / 4096;
        bright |= point.object == 8;
      }
    }
    believed += bright;
    EXPECT_NEAR(double(warped.colour(p).g), mean, 4 * 0.05 * std::max(mean, 0.1 * picture)) << p;
  }
  EXPECT_GT(believed, 20);
}

/// A rigid object that is painted in its own space looks the same wherever it moves. Seen to fail: the object's own
/// motion left out.
TEST(Warp, AMovingObjectIsFollowed) {
  const Cornell before(8), now(14);
  const View a(before, kMiddle), view(now, kMiddle);
  const auto own = [](const Cornell& room) {
    const Affine node_from_world = inverse(room.frame.world_from_node[8]);
    return Paint([node_from_world](Vec3d p, std::uint32_t object) {
      const Vec3d q = object == 8 ? node_from_world.point(p) : p;
      return Rgb{float(1 + q.x), float(1 + q.y), float(1 + q.z)};
    });
  };
  const Image key = painted(a, own(before)), truth = painted(view, own(now));
  const Warped warped(view, {{a, key}});
  int box = 0;
  for (std::size_t p = 0; p < truth.pixel_count(); ++p) {
    if (view.seen.seen().object[p] != 8 || warped.frame.why[p] != 0) continue;
    const Rgb c = warped.colour(p);
    ++box;
    // Beside an edge the nearest of 16 pixels is taken: at most two pixels away along the face, in either view.
    const Vec3d to_eye = normalize(Vec3d{0, 1, 1.9} - world_at(view, p));
    const double facing = std::abs(dot(to_eye, Vec3d(view.seen.seen().normal[p])));
    const double near =
        3 * view.seen.camera().pixel_width() * double(view.seen.seen().depth[p]) / std::max(facing, 0.05);
    EXPECT_NEAR(c.r, truth.find("R")->values[p], near) << p;
    EXPECT_NEAR(c.g, truth.find("G")->values[p], near) << p;
    EXPECT_NEAR(c.b, truth.find("B")->values[p], near) << p;
  }
  EXPECT_GT(box, 100);
}

/// Light differs between the keys by a fifth, with a noise of a tenth per pixel. Over 25 pixels this is 7 standard
/// errors of .1 sqrt(2)/5, so it is detected. Equal light with the same noise is masked only in the 3 of 1000 pixels
/// above 3 standard errors, and in the pixels that one key alone shows, 2 of 96 columns at the left and right border.
/// Seen to fail: noise not told from a change.
TEST(Warp, ChangedLightIsTold) {
  const Cornell room;
  const View view(room, kMiddle), a(room, camera_at({0.02, 1, 1.9})), b(room, camera_at({-0.02, 1, 1.9}));
  const auto lit = [](double light, int seed) {
    return Paint([light, seed, n = 0](Vec3d, std::uint32_t) mutable {
      const double noise =
          0.2 * std::sqrt(3.0) * (PathRandom(std::uint64_t(seed), 1).get1(std::uint32_t(n++), Purpose::test) - 0.5);
      return Rgb(float(light + noise));
    });
  };
  const auto share = [&](double light_of_b, bool may_differ) {
    const Warped warped(view, {{a, painted(a, lit(1, 1)), 1, false, may_differ},
                               {b, painted(b, lit(light_of_b, 2)), 1, false, may_differ}});
    int changed = 0;
    for (const std::uint32_t why : warped.frame.why) changed += (why & why_changed_light) != 0;
    return double(changed) / double(warped.frame.why.size());
  };
  EXPECT_GT(share(1.2, true), 0.8);
  EXPECT_LT(share(1.0, true), 0.05);
  EXPECT_EQ(share(1.2, false), 0);  // the plan says that no light changes
}

TEST(Warp, SpecularLightThatMattersIsMasked) {
  const Cornell room;
  const View view(room, kMiddle), a(room, camera_at({0.02, 1, 1.9})), b(room, camera_at({-0.02, 1, 1.9}));
  const auto key = [](const View& from, float gloss) {
    Image image = painted(from, [](Vec3d, std::uint32_t) { return Rgb(1.0f); });
    for (const char* name : {"specular.R", "specular.G", "specular.B"})
      for (float& value : image.add(name).values) value = gloss;
    return image;
  };
  // A viewer with sharp sight who sees errors of a tenth of the light.
  const auto seen = [](const GlossInDoubt& doubt) {
    std::vector<float> probability;
    for (std::size_t p = 0; p < doubt.counted.size(); ++p)
      probability.push_back(doubt.counted[p] && std::abs(doubt.error[1][p]) > 0.1f * doubt.picture[1][p] ? 1.0f : 0.0f);
    return probability;
  };
  const auto masked = [&](float gloss_a, float gloss_b, bool judged) {
    const Warped warped(view, {{a, key(a, gloss_a)}, {b, key(b, gloss_b)}}, {.slow_deg_per_s = 0},
                        judged ? seen : std::function<std::vector<float>(const GlossInDoubt&)>());
    int count = 0;
    for (const std::uint32_t why : warped.frame.why) count += (why & why_specular) != 0;
    return double(count) / double(warped.frame.why.size());
  };
  EXPECT_GT(masked(0.2f, 0.35f, true), 0.9);
  EXPECT_LT(masked(0.2f, 0.28f, true), 0.1);    // one key alone is not enough
  EXPECT_GT(masked(0.2f, 0.2f, false), 0.9);    // without a viewer's model all gloss is masked
  EXPECT_EQ(masked(0.005f, 0.018f, false), 0);  // below a fiftieth of the light
}

/// The frame has all layers, and their sum is RGB to the bit, also after warping.
TEST(Warp, LayersStillAddUp) {
  const Cornell room;
  const View view(room, kMiddle), a(room, camera_at({0.03, 1, 1.9})), b(room, camera_at({-0.02, 1, 1.9}));
  const auto layered = [](const View& from) {
    Image image = painted(from, smooth_paint);
    for (const std::string c : {"R", "G", "B"}) {
      std::vector<float> direct(image.pixel_count()), indirect(image.pixel_count()), &sum = image.find(c)->values;
      for (std::size_t p = 0; p < sum.size(); ++p) {
        direct[p] = 0.3f * sum[p];
        indirect[p] = 0.61f * sum[p];
        sum[p] = direct[p] + indirect[p];
      }
      image.add("direct." + c).values = direct;
      image.add("indirect." + c).values = indirect;
    }
    return image;
  };
  const Warped warped(view, {{a, layered(a)}, {b, layered(b)}});
  ASSERT_EQ(warped.frame.names, (std::vector<std::string>{"A", "B", "G", "R", "direct.B", "direct.G", "direct.R",
                                                          "indirect.B", "indirect.G", "indirect.R"}));
  for (std::size_t p = 0; p < warped.frame.why.size(); ++p) {
    const std::vector<std::vector<float>>& c = warped.frame.colour;
    for (std::size_t i = 0; i < 3; ++i) ASSERT_EQ(c[1 + i][p], c[4 + i][p] + c[7 + i][p]);
    if (warped.frame.why[p] == 0) { ASSERT_EQ(c[0][p], 1.0f); }
  }
}

TEST(Warp, NothingCrossesACut) {
  const Cornell room;
  const View view(room, kMiddle), a(room, camera_at({0.02, 1, 1.9}));
  const auto white = [](Vec3d, std::uint32_t) { return Rgb(1.0f); };
  const auto grey = [](Vec3d, std::uint32_t) { return Rgb(0.5f); };
  const Warped one(view, {{a, painted(a, white)}, {view, painted(view, grey), 1, true}});
  for (std::size_t p = 0; p < one.frame.why.size(); ++p)
    if (one.frame.why[p] == 0) { ASSERT_EQ(one.colour(p), Rgb(1.0f)); }
  const Warped none(view, {{view, painted(view, grey), 1, true}});
  for (std::size_t p = 0; p < none.frame.why.size(); ++p) ASSERT_EQ(none.frame.why[p], why_border);
}

}  // namespace
}  // namespace tempolux::test
