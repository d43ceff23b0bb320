#include "lib/image/specular_glossiness.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/image/srgb.h"

namespace tempolux {
namespace {

constexpr float kDielectric = 0.04f;  ///< F0 of ior 1.5

float mean(Rgb c) { return (c.r + c.g + c.b) / 3; }

/// Colours of an image at any size. White where there is no image.
class Texels {
 public:
  explicit Texels(const CodedPixels& pixels) : pixels_(pixels) {}

  /// Linear colour and alpha at the centre of a texel of an image of another size.
  std::array<float, 4> at(int x, int y, int width, int height) const {
    if (pixels_.bytes.empty()) return {1, 1, 1, 1};
    const auto from = [](int i, int n, int of) { return std::size_t((std::int64_t(2 * i + 1) * of) / (2 * n)); };
    const std::size_t texel =
        from(y, height, pixels_.height) * std::size_t(pixels_.width) + from(x, width, pixels_.width);
    const bool grey = pixels_.channels < 3;
    std::array<float, 4> value{0, 0, 0, 1};
    for (int c = 0; c < 3; ++c) value[std::size_t(c)] = srgb_to_linear(code(texel, grey ? 0 : c));
    if (pixels_.channels % 2 == 0) value[3] = code(texel, pixels_.channels - 1);
    return value;
  }

 private:
  float code(std::size_t texel, int channel) const {
    const std::size_t sample = texel * std::size_t(pixels_.channels) + std::size_t(channel);
    if (pixels_.bits == 8) return float(pixels_.bytes[sample]) / 255;
    std::uint16_t value;
    std::copy_n(&pixels_.bytes[2 * sample], 2, reinterpret_cast<unsigned char*>(&value));
    return float(value) / 65535;
  }

  const CodedPixels& pixels_;
};

std::uint8_t code_of(float value) { return std::uint8_t(std::lround(255 * std::clamp(value, 0.0f, 1.0f))); }

}  // namespace

MetallicTexel metallic_of(Rgb diffuse, Rgb specular) {
  const float d = mean(diffuse), s = mean(specular);
  if (!(s > kDielectric)) return {diffuse, 0};
  // The smaller root, in a form without the difference of two nearly equal numbers. It lies from 0 to 1.
  const float sum = d + s;
  const float x = std::min(1.0f, 2 * d / (sum + std::sqrt(std::max(0.0f, sum * sum - 4 * kDielectric * d))));
  const float metallic = 1 - x;
  MetallicTexel texel{Rgb(0.0f), metallic};
  // Each channel has two equations for one base colour. The lobe that carries more of the material decides.
  const float share = metallic * metallic;
  for (int c = 0; c < 3; ++c) {
    const float by_diffuse = x > 0 ? diffuse[c] / x : 0;
    const float by_specular = metallic > 0 ? (specular[c] - kDielectric * x) / metallic : 0;
    texel.base_color[c] = std::clamp(by_diffuse + (by_specular - by_diffuse) * share, 0.0f, 1.0f);
  }
  return texel;
}

CodedPixels SpecularGlossiness::make(const CodedPixels& diffuse_pixels, const CodedPixels& specular_pixels) const {
  const Texels diffuse_texels(diffuse_pixels), specular_texels(specular_pixels);
  CodedPixels made;
  made.width = std::max({diffuse_pixels.width, specular_pixels.width, 1});
  made.height = std::max({diffuse_pixels.height, specular_pixels.height, 1});
  made.channels = makes == Makes::base_color ? 4 : 3;
  made.bytes.reserve(std::size_t(made.width) * std::size_t(made.height) * std::size_t(made.channels));
  for (int y = 0; y < made.height; ++y)
    for (int x = 0; x < made.width; ++x) {
      const std::array<float, 4> d = diffuse_texels.at(x, y, made.width, made.height);
      const std::array<float, 4> s = specular_texels.at(x, y, made.width, made.height);
      const std::uint8_t roughness = code_of(1 - glossiness_factor * s[3]);
      if (makes == Makes::roughness) {
        made.bytes.insert(made.bytes.end(), {0, roughness, 255});
        continue;
      }
      const MetallicTexel texel =
          metallic_of(Rgb{d[0], d[1], d[2]} * diffuse_factor, Rgb{s[0], s[1], s[2]} * specular_factor);
      if (makes == Makes::metallic_roughness) {
        made.bytes.insert(made.bytes.end(), {0, roughness, code_of(texel.metallic)});
        continue;
      }
      for (int c = 0; c < 3; ++c) made.bytes.push_back(code_of(linear_to_srgb(texel.base_color[c])));
      made.bytes.push_back(code_of(d[3]));
    }
  return made;
}

}  // namespace tempolux
