// lib/aqm/fourier.h -- Fourier transforms of pictures by FFTW, which the module modules/tempolux-fourier.cpp links.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <new>

#include "formats/large_pages.h"
#include "lib/aqm/fourier_module.h"

namespace tempolux {

/// `count` floats or complex floats, uninitialised, aligned for FFTW.
template <class T>
class FourierArray {
 public:
  explicit FourierArray(std::size_t count)
      : data_(static_cast<T*>(::operator new (count * sizeof(T), std::align_val_t{kFourierAlignment}))), count_(count) {
    formats::prefer_large_pages(data_.get(), count * sizeof(T));
  }
  std::size_t size() const { return count_; }
  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }
  T& operator[](std::size_t i) { return data_.get()[i]; }
  const T& operator[](std::size_t i) const { return data_.get()[i]; }

 private:
  struct Free {
    void operator()(T* data) const { ::operator delete (data, std::align_val_t{kFourierAlignment}); }
  };
  std::unique_ptr<T, Free> data_;
  std::size_t count_;
};

/// The smallest number >= n whose only prime factors are 2, 3 and 5: such sizes are transformed fast. n >= 1.
int fast_transform_size(int n);

/// Two-dimensional transforms, row by row, not normalised. Any thread may call. The first object loads the module;
/// throws InputError if the module is missing, std::bad_alloc without memory.
class FourierTransform {
 public:
  FourierTransform();
  /// F(u, v) = sum of f(x, y) exp(-2 pi i (u x / width + v y / height)), u from 0 to width / 2, as rows of
  /// width / 2 + 1.
  FourierArray<std::complex<float>> forward(FourierArray<float>& picture, int width, int height) const;
  /// f(x, y) = sum of F(u, v) exp(2 pi i (u x / width + v y / height)), in place.
  void inverse(FourierArray<std::complex<float>>& spectrum, int width, int height) const;

 private:
  void run(const FourierRequest& request) const;
  FourierEntry* entry_;
};

}  // namespace tempolux
