// lib/aqm/fourier.cpp -- calls the module that links FFTW.
#include "lib/aqm/fourier.h"

#include "formats/error.h"
#include "lib/image/open_module.h"

namespace tempolux {
namespace {

bool is_fast(int n) {
  for (const int prime : {2, 3, 5})
    while (n % prime == 0) n /= prime;
  return n == 1;
}

}  // namespace

int fast_transform_size(int n) {
  while (!is_fast(n)) ++n;
  return n;
}

FourierTransform::FourierTransform()
    : entry_(reinterpret_cast<FourierEntry*>(module_symbol(
          "tempolux-fourier.so", kFourierSymbol, "the model of vision",
          "install all of tempolux together, or leave out --metric aqm and --flow for the error figures"))) {}

FourierArray<std::complex<float>> FourierTransform::forward(FourierArray<float>& picture, int width, int height) const {
  FourierArray<std::complex<float>> spectrum(std::size_t(width / 2 + 1) * std::size_t(height));
  run({kFourierAbi, fourier_forward, width, height, picture.data(), reinterpret_cast<float*>(spectrum.data())});
  return spectrum;
}

void FourierTransform::inverse(FourierArray<std::complex<float>>& spectrum, int width, int height) const {
  auto* data = reinterpret_cast<float*>(spectrum.data());
  run({kFourierAbi, fourier_inverse, width, height, data, data});
}

void FourierTransform::run(const FourierRequest& request) const {
  switch (entry_(&request)) {
    case fourier_ok: return;
    case fourier_bad_version:
      throw InputError("tempolux-fourier.so is of another version than the tool; install both together");
    default: throw std::bad_alloc();
  }
}

}  // namespace tempolux
