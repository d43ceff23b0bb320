// formats/photons/records.cpp -- checks photons (photons.md, sections 4 and 5) and sums their flux.
#include <immintrin.h>

#include <algorithm>
#include <limits>

#include "formats/float_bits.h"
#include "formats/photons/layout.h"

namespace tempolux::formats::photons {
namespace {

/// The reason for refusing a photon; "" if the photon is valid. Reader and writer both call it.
std::string_view fault_of(const Photon& photon, const RecordRules& rules) {
  for (float x : photon.position)
    if (!is_finite(x)) return "position is not finite";
  for (float x : photon.flux) {
    if (!is_finite(x)) return "flux is not finite";
    if (is_negative(x) && !rules.signed_flux) return "flux is negative, which only map dynamic allows";
  }
  if (photon.normal[0] == 0xffff || photon.normal[1] == 0xffff) return "normal is above 65534";
  const auto kind = static_cast<unsigned>(photon.kind);
  if (kind >= kPathKinds) return "kind is not known";
  if (!((rules.kinds >> kind) & 1)) return "kind is not one of those the header names";
  return "";
}

/// True if any of the photons would be refused; tests many at once.
bool any_bad(std::span<const Photon> photons, const RecordRules& rules) {
  const int exponent = 0x7f800000, none = 1;  // exponent & anything is never 1
  const __m256i mask = _mm256_setr_epi32(exponent, exponent, exponent, exponent, exponent, exponent, 0, 0);
  const __m256i infinite = _mm256_setr_epi32(exponent, exponent, exponent, exponent, exponent, exponent, none, none);
  const int sign = rules.signed_flux ? 0 : -1;
  const __m256i flux = _mm256_setr_epi32(0, 0, 0, sign, sign, sign, 0, 0);
  const __m256i minus_zero = _mm256_set1_epi32(std::numeric_limits<int>::min());
  const __m256i normal = _mm256_setr_epi32(0, 0, 0, 0, 0, 0, -1, 0);
  __m256i bad = _mm256_setzero_si256();
  std::uint64_t bad_kind = 0;
  const std::uint64_t refused = ~std::uint64_t(rules.kinds & 31);
  for (const Photon& photon : photons) {
    const __m256i words = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(&photon));
    bad = _mm256_or_si256(bad, _mm256_cmpeq_epi32(_mm256_and_si256(words, mask), infinite));
    const __m256i negative = _mm256_andnot_si256(_mm256_cmpeq_epi32(words, minus_zero), words);
    bad = _mm256_or_si256(bad, _mm256_and_si256(_mm256_srai_epi32(negative, 31), flux));
    bad = _mm256_or_si256(bad, _mm256_and_si256(_mm256_cmpeq_epi16(words, _mm256_set1_epi16(-1)), normal));
    const auto kind = static_cast<unsigned>(photon.kind);
    bad_kind |= ((refused >> (kind & 63)) & 1) | (kind >> 6);
  }
  return bad_kind != 0 || !_mm256_testz_si256(bad, bad);
}

}  // namespace

std::optional<RecordError> find_bad_photon(std::span<const Photon> photons, const RecordRules& rules) {
  if (!any_bad(photons, rules)) return std::nullopt;
  for (std::size_t i = 0; i < photons.size(); ++i)
    if (const std::string_view reason = fault_of(photons[i], rules); !reason.empty()) return RecordError{i, reason};
  return std::nullopt;
}

std::optional<RecordError> find_bad_direction(std::span<const std::array<std::uint16_t, 2>> directions) {
  const auto bad = std::find_if(directions.begin(), directions.end(),
                                [](const auto& code) { return code[0] == 0xffff || code[1] == 0xffff; });
  if (bad == directions.end()) return std::nullopt;
  return RecordError{std::size_t(bad - directions.begin()), "direction is above 65534"};
}

void FluxSum::add(std::span<const Photon> photons) {
  for (const Photon& photon : photons) ExactRgbSum::add(photon.flux);
}

void add_up(std::span<const GroupFlux> ledger, PhotonTotals& totals) {
  totals.emitted_flux = totals.escaped_flux = totals.absorbed_flux = {};
  for (const GroupFlux& group : ledger)
    for (std::size_t c = 0; c < 3; ++c) {
      totals.emitted_flux[c] += group.emitted[c];
      totals.escaped_flux[c] += group.escaped[c];
      totals.absorbed_flux[c] += group.absorbed[c];
    }
}

}  // namespace tempolux::formats::photons
