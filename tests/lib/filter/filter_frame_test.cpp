// The filter on pictures whose answer is known: constant, noise, edges, ramps, steps of light that move, what passes by.
#include "lib/filter/filter_frame.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/core/parallel.h"
#include "lib/image/exr_io.h"
#include "tests/support/filter_frames.h"

namespace tempolux {
namespace {

using test::at;
using test::everywhere;
using test::filtered;
using test::grey;
using test::moves;
using test::Noise;
using test::plane;
using test::tell_variance;
using test::wall;

TEST(Filter, AConstantPictureStays) {
  for (const bool told : {false, true}) {
    Image frame = wall(40, 24);
    grey(frame, "", everywhere(0.7f));
    moves(frame, 30, 0);
    if (told) tell_variance(frame, 0.01f);
    const Image out = filtered(std::vector<Image>(5, frame));
    for (const char* c : {"R", "G", "B"})
      for (const float v : out.find(c)->values) EXPECT_NEAR(v, 0.7f, 0.7e-6f);
  }
}

/// With plain weights the filter is linear and the same everywhere inside: the answers to one bright pixel in each frame are its weights, their
/// sum is 1, and white noise comes out with the sum of their squares for a variance. 17 000 pixels, each like about 10 around: the variance of
/// that many is known to sqrt(2 x 10 / 17000) = 3.4 %; 4 sigma.
TEST(Filter, WhiteNoiseComesOutWithTheSumOfSquaredWeights) {
  constexpr int kWidth = 400, kHeight = 96, kStep = 40;   // 40 pixels a frame at 24 frames and 30 pixels per degree: 32 deg/s
  const auto frame_of = [&](const test::OfPixel& value) {
    Image frame = wall(kWidth, kHeight);
    grey(frame, "", value);
    moves(frame, kStep, 0);
    return frame;
  };
  double sum = 0, squares = 0;
  for (int f = 0; f < 5; ++f) {
    std::vector<Image> frames(5, frame_of(everywhere(0)));
    const int x0 = kWidth / 2 + (f - 2) * kStep;
    frames[std::size_t(f)] = frame_of([&](int x, int y) { return x == x0 && y == kHeight / 2 ? 1.0f : 0.0f; });
    const Image answer = filtered(frames);
    for (const float w : answer.find("G")->values) {
      sum += double(w);
      squares += double(w) * double(w);
    }
  }
  EXPECT_NEAR(sum, 1, 1e-5);
  EXPECT_LT(squares, 0.1);
  Noise noise(1);
  std::vector<Image> frames;
  for (int f = 0; f < 5; ++f) frames.push_back(frame_of([&](int, int) { return noise(); }));
  const Image out = filtered(frames);
  double variance = 0;
  int count = 0;
  for (int y = 8; y < kHeight - 8; ++y)
    for (int x = 2 * kStep + 8; x < kWidth - 2 * kStep - 8; ++x, ++count) variance += std::pow(double(at(out, "G", x, y)), 2);
  EXPECT_NEAR(variance / count / squares, 1, 0.14);
}

/// Two sides, told apart by object, by depth or by normal, whose values differ by less than their noise: no light of one in the other.
TEST(Filter, NothingCrossesAnEdge) {
  for (const std::string by : {"object", "depth", "normal"}) {
    Image frame = wall(40, 24);
    grey(frame, "", [](int x, int) { return x < 20 ? 1.0f : 1.1f; });
    tell_variance(frame, 1);
    for (int y = 0; y < 24; ++y)
      for (int x = 20; x < 40; ++x) {
        const auto p = std::size_t(y * 40 + x);
        if (by == "object") frame.find("id.object")->ids[p] = 1;
        if (by == "depth") frame.find("Z")->values[p] = 2.2f;
        if (by == "normal") frame.find("N.Z")->values[p] = 0.8f, frame.find("N.X")->values[p] = 0.6f;
      }
    const Image out = filtered(std::vector<Image>(5, frame));
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 40; ++x) EXPECT_NEAR(at(out, "G", x, y), x < 20 ? 1.0f : 1.1f, 2e-6f) << by << " " << x;
  }
}

/// Light that changes evenly is a plane everywhere, also where the window is cut at the picture's border (a mean would be off by 3 steps there).
TEST(Filter, ARampStaysUpToItsBorder) {
  Image frame = wall(40, 24);
  const auto ramp = [](int x, int y) { return 1 + 0.01f * float(x) - 0.02f * float(y); };
  grey(frame, "", ramp);
  tell_variance(frame, 1);
  const Image out = filtered({frame});
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 40; ++x) EXPECT_NEAR(at(out, "G", x, y), ramp(x, y), 0.01f) << x << " " << y;
}

/// A step of light, 1 to 2, that moves by four pixels a frame over a wall that stands. Noise of .1: every column's mean error over 60 lines is within
/// 4 sigma of the noise that was there, .1 / sqrt(60). (Without comparing values the columns it passes in five frames are off by .2 to .8.)
/// Without noise, and told so, the picture stays.
TEST(Filter, AMovingStepOfLightLeavesNoTrail) {
  for (const float deviation : {0.0f, 0.1f}) {
    Noise noise(1);
    std::vector<Image> frames;
    const auto light = [](int f, int x) { return x < 30 + 4 * (f - 2) ? 2.0f : 1.0f; };
    for (int f = 0; f < 5; ++f) {
      Image frame = wall(60, 60);
      std::vector<float> values;
      for (int p = 0; p < 3600; ++p) values.push_back(light(f, p % 60) + deviation * noise());
      grey(frame, "", [&](int x, int y) { return values[std::size_t(y * 60 + x)]; });
      tell_variance(frame, deviation * deviation);
      moves(frame, 0, 0);
      frames.push_back(frame);
    }
    const Image out = filtered(frames);
    for (int x = 0; x < 60; ++x) {
      double error = 0;
      for (int y = 0; y < 60; ++y) error += double(at(out, "G", x, y) - light(2, x)) / 60;
      EXPECT_NEAR(error, 0, deviation > 0 ? 4 * 0.1 / std::sqrt(60.0) : 1e-6) << x;
    }
  }
}

/// A pattern that moves with its wall by (3, -2) pixels a frame, v up: followed the right way five frames average its noise to 1/sqrt(5) of
/// it; 2000 pixels know that to 1.6 %. A wrong sign mixes what differs by twenty times the noise, and is left out: nothing is gained.
TEST(Filter, TheFlowIsFollowedTheRightWay) {
  const auto pattern = [](int x, int y) { return float((x * 7 + y * 13) % 5); };
  for (const float sign : {1.0f, -1.0f}) {
    Noise noise(0.1f);
    std::vector<Image> frames;
    for (int f = -2; f <= 2; ++f) {
      Image frame = wall(64, 64);
      std::vector<float> values;
      for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) values.push_back(10 * pattern(x - 3 * f + 100, y - 2 * f + 100) + noise());
      grey(frame, "", [&](int x, int y) { return values[std::size_t(y * 64 + x)]; });
      tell_variance(frame, 0.01f);
      moves(frame, sign * 3, sign * -2);
      frames.push_back(frame);
    }
    FilterOptions options;
    options.radius = 0;
    const Image out = filtered(frames, options);
    double square = 0;
    for (int y = 10; y < 54; ++y)
      for (int x = 10; x < 54; ++x) square += std::pow(double(at(out, "G", x, y)) - double(10 * pattern(x + 100, y + 100)), 2) / (44 * 44);
    if (sign > 0) EXPECT_NEAR(std::sqrt(square), 0.1 / std::sqrt(5), 0.07 * 0.1 / std::sqrt(5));
    else EXPECT_GT(std::sqrt(square), 0.08);
  }
}

/// Texture is not light: a chequered wall under even light keeps every square.
TEST(Filter, AlbedoIsNotBlurred) {
  const auto albedo = [](int x, int y) { return (x + y) % 2 == 0 ? 0.9f : 0.1f; };
  Image frame = wall(32, 32);
  grey(frame, "direct", [&](int x, int y) { return albedo(x, y) * 3; });
  grey(frame, "albedo", albedo);
  tell_variance(frame, 4);
  const Image out = filtered({frame, frame, frame});
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) EXPECT_NEAR(at(out, "direct.G", x, y), albedo(x, y) * 3, 1e-5f);
}

Image layered_frame(Noise& noise) {
  Image frame = wall(32, 24);
  for (const char* c : {"R", "G", "B"}) frame.add(c);
  for (const char* layer : {"emission", "specular", "direct", "caustic", "indirect"}) {
    grey(frame, layer, [&](int, int) { return std::abs(noise()); });
    for (const char* c : {"R", "G", "B"})
      for (std::size_t p = 0; p < frame.pixel_count(); ++p) frame.find(c)->values[p] += frame.find(layer + std::string(".") + c)->values[p];
  }
  tell_variance(frame, 0.1f);
  return frame;
}

TEST(Filter, EmissionAndSpecularPassAndLayersSumToTheImage) {
  Noise noise(1);
  const Image frame = layered_frame(noise);
  const Image out = filtered({frame});
  for (const char* c : {"R", "G", "B"}) {
    for (const char* layer : {"emission.", "specular."})
      EXPECT_EQ(out.find(layer + std::string(c))->values, frame.find(layer + std::string(c))->values);
    EXPECT_NE(out.find("direct." + std::string(c))->values, frame.find("direct." + std::string(c))->values);
    for (std::size_t p = 0; p < 32 * 24; ++p) {
      float sum = 0;
      for (const char* layer : {"emission.", "specular.", "direct.", "caustic.", "indirect."}) sum += out.find(layer + std::string(c))->values[p];
      EXPECT_EQ(out.find(c)->values[p], sum);
    }
  }
}

/// Light of smoke passes and stays in the picture. Of a frame that has some layers alone the picture changes as they do, and keeps the rest: here 5.
TEST(Filter, ThePictureKeepsWhatIsInNoFilteredLayer) {
  Noise noise(1);
  Image smoky = layered_frame(noise);
  grey(smoky, "volume", everywhere(2));
  for (const char* c : {"R", "G", "B"})
    for (float& value : smoky.find(c)->values) value += 2;
  const Image of_smoky = filtered({smoky});
  for (std::size_t p = 0; p < 32 * 24; ++p) {
    float sum = 0;
    for (const char* layer : {"emission.G", "specular.G", "direct.G", "caustic.G", "indirect.G", "volume.G"}) sum += of_smoky.find(layer)->values[p];
    EXPECT_EQ(of_smoky.find("G")->values[p], sum);
  }
  Image some = layered_frame(noise);
  std::erase_if(some.channels, [](const Channel& channel) { return channel.name.starts_with("emission") || channel.name.starts_with("specular"); });
  for (std::size_t p = 0; p < 32 * 24; ++p)   // R and B hold what was taken out
    some.find("G")->values[p] = some.find("direct.G")->values[p] + some.find("caustic.G")->values[p] + some.find("indirect.G")->values[p] + 5;
  const Image of_some = filtered({some});
  for (std::size_t p = 0; p < 32 * 24; ++p)   // of numbers up to about 15: some roundings of 2^-21
    EXPECT_NEAR(of_some.find("G")->values[p], of_some.find("direct.G")->values[p] + of_some.find("caustic.G")->values[p] + of_some.find("indirect.G")->values[p] + 5, 1e-5f);
}

/// A quarter of the pixels in column 20 is what column 19 shows. Their own sample is of either side; what comes out is the mixture, from both
/// sides' other pixels; emission, which is not filtered, likewise.
TEST(Filter, EdgesArePutTogetherByCoverage) {
  Image frame = wall(40, 24);
  const auto mixed = [](int x, int y) { return x < 20 ? 4.0f : x > 20 ? 1.0f : y % 4 == 0 ? 4.0f : 1.0f; };
  grey(frame, "direct", mixed);
  grey(frame, "emission", mixed);
  plane(frame, "samples", everywhere(1));
  frame.add_ids("coverage");
  for (int y = 0; y < 24; ++y)
    for (int x = 20; x < 40; ++x) {
      frame.find("id.object")->ids[std::size_t(y * 40 + x)] = 1;
      if (x == 20) frame.find("coverage")->ids[std::size_t(y * 40 + x)] = 4u << 12;
    }
  const Image out = filtered({frame});
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 40; ++x) {
      const float expected = x < 20 ? 4.0f : x > 20 ? 1.0f : 1.75f;
      EXPECT_NEAR(at(out, "direct.G", x, y), expected, 1e-5f) << x << " " << y;
      EXPECT_NEAR(at(out, "emission.G", x, y), expected, 1e-5f) << x << " " << y;
    }
}

/// What passes the filter at an edge pixel is the mean of n samples, 6, where both sides have 2: one sample is not believed; of 17 the mean counts as much
/// as what 16 rays of coverage put together; of 129 by 8^(5/3) = 32.
TEST(Filter, ManySamplesOfWhatPassesAreBelievedAtEdges) {
  for (const auto& [samples, expected] : {std::pair{1.0f, 2.0f}, {17.0f, 4.0f}, {129.0f, 2 + 4 * 32.0f / 33}}) {
    Image frame = wall(40, 24);
    grey(frame, "direct", everywhere(1));
    grey(frame, "specular", [](int x, int) { return x == 20 ? 6.0f : 2.0f; });
    plane(frame, "samples", everywhere(samples));
    frame.add_ids("coverage");
    for (int y = 0; y < 24; ++y)
      for (int x = 20; x < 40; ++x) {
        frame.find("id.object")->ids[std::size_t(y * 40 + x)] = 1;
        if (x == 20) frame.find("coverage")->ids[std::size_t(y * 40 + x)] = 4u << 12;
      }
    const Image out = filtered({frame});
    for (int y = 0; y < 24; ++y) {
      EXPECT_NEAR(at(out, "specular.G", 20, y), expected, 1e-5f) << samples;
      EXPECT_EQ(at(out, "specular.G", 10, y), 2.0f);
    }
  }
}

TEST(Filter, EdgesStayAsTheyAreWhereCoverageIsNotKnown) {
  Image frame = wall(40, 24);
  Noise noise(1);
  grey(frame, "", [&](int, int) { return noise(); });
  tell_variance(frame, 1);
  for (int y = 0; y < 24; ++y)
    for (int x = 20; x < 40; ++x) frame.find("id.object")->ids[std::size_t(y * 40 + x)] = 1;
  const Image out = filtered({frame, frame, frame});
  for (int y = 0; y < 24; ++y) {
    EXPECT_EQ(at(out, "G", 20, y), at(frame, "G", 20, y));
    EXPECT_NE(at(out, "G", 25, y), at(frame, "G", 25, y));
  }
}

/// Nothing that is not a number comes out, whatever goes in; values beyond squares in float32 stay.
TEST(Filter, StrangePixelsAreLeftOutAndFilled) {
  Image frame = wall(16, 16);
  grey(frame, "", [](int x, int y) {
    if (y == 3) return x == 3 ? NAN : x == 8 ? INFINITY : x == 12 ? -INFINITY : 1.0f;
    return x == 3 && y == 12 ? 1e30f : 1.0f;
  });
  tell_variance(frame, 0.01f);
  moves(frame, 1e4f, -1e4f);
  frame.find("forward.u")->values[5] = NAN;
  frame.find("Z")->values[7] = NAN;
  frame.find("Z")->values[9] = 0;
  const Image out = filtered({frame, frame, frame});
  for (const int x : {3, 8, 12}) EXPECT_NEAR(at(out, "G", x, 3), 1, 1e-5f) << x;
  EXPECT_EQ(at(out, "G", 3, 12), 1e30f);
  for (const Channel& channel : out.channels)
    for (const float v : channel.values) EXPECT_TRUE(std::isfinite(v) || (channel.name == "Z" && v > 0)) << channel.name;
  Image one = wall(1, 1);
  grey(one, "", everywhere(0));
  EXPECT_EQ(at(filtered({one, one}), "G", 0, 0), 0);
}

TEST(Filter, TheSameBytesForAnyThreads) {
  Noise noise(1);
  std::vector<Image> frames;
  for (int f = 0; f < 3; ++f) frames.push_back(layered_frame(noise));
  std::string first;
  for (const int threads : {1, 2, 3, 7}) {
    const ThreadLimit limit(threads);
    const std::string digest = digest_of(filtered(frames));
    if (first.empty()) first = digest;
    EXPECT_EQ(digest, first) << threads;
  }
}

}  // namespace
}  // namespace tempolux
