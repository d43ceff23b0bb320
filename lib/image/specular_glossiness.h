// lib/image/specular_glossiness.h -- textures of KHR_materials_pbrSpecularGlossiness as textures of metallic-roughness.
#pragma once

#include <cstddef>

#include "lib/core/vec.h"
#include "lib/image/encoded_image.h"

namespace tempolux {

/// Base colour and metallic share of a texel that has a diffuse albedo and an F0 of its own.
struct MetallicTexel {
  Rgb base_color{0.0f};
  float metallic = 0;
};

/// The metallic-roughness material, of ior 1.5, that comes closest to a Lambert albedo `diffuse` and a reflectance
/// `specular` at normal incidence. With x = 1 - metallic, both are met where base_color x = diffuse and
/// .04 x + base_color metallic = specular, so that .04 x^2 - (diffuse + specular) x + diffuse = 0 for the means of R, G
/// and B. A specular reflectance below .04 cannot be met: metallic is then 0.
MetallicTexel metallic_of(Rgb diffuse, Rgb specular);

/// Makes one image of a metallic-roughness material from the two images of a specular-glossiness material, whose
/// texture coordinates must be the same. The image has the size of the larger one; the smaller one is read at its
/// nearest texel.
struct SpecularGlossiness {
  enum class Makes {
    base_color,          ///< sRGB and alpha
    metallic_roughness,  ///< linear: G roughness, B metallic
    roughness,           ///< linear: G roughness, B 255
  };
  Makes makes = Makes::base_color;
  static constexpr std::size_t kWhite = ~std::size_t{0};  ///< in place of an image: there is none
  std::size_t diffuse = kWhite;                           ///< index in TextureImages: sRGB and alpha
  std::size_t specular = kWhite;                          ///< likewise: sRGB, and glossiness as alpha
  Rgb diffuse_factor{1.0f}, specular_factor{1.0f};
  float glossiness_factor = 1;

  /// `diffuse` and `specular` are the decoded images; without pixels where there is none.
  CodedPixels make(const CodedPixels& diffuse, const CodedPixels& specular) const;
};

}  // namespace tempolux
