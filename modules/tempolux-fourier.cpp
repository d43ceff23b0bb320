// modules/tempolux-fourier.cpp -- Fourier transforms with FFTW. lib/aqm/fourier.cpp opens this module when it judges
// differences as an eye sees them.
//
// A separate shared object, so that comparisons by error figures alone do not load FFTW. Plans are FFTW's estimates and
// not measured: every run executes the same operations and so gives the same bytes.
#include <fftw3.h>

#include <map>
#include <mutex>
#include <tuple>

#include "lib/aqm/fourier_module.h"

namespace {

using tempolux::FourierRequest;

/// Plans by kind, width and height.
struct Plans : std::map<std::tuple<int, int, int>, fftwf_plan> {
  ~Plans() {
    for (const auto& [size, plan] : *this) fftwf_destroy_plan(plan);
    fftwf_cleanup();
  }
};

/// The plan for a kind and size, made by the first call. FFTW's planner is not thread-safe, but executing a plan is.
fftwf_plan plan_for(const FourierRequest& request) {
  static std::mutex planner;
  static Plans plans;
  const std::lock_guard lock(planner);
  fftwf_plan& plan = plans[{request.kind, request.width, request.height}];
  if (plan) return plan;
  auto* out = reinterpret_cast<fftwf_complex*>(request.out);
  if (request.kind == tempolux::fourier_forward)
    plan = fftwf_plan_dft_r2c_2d(request.height, request.width, request.in, out, FFTW_ESTIMATE | FFTW_PRESERVE_INPUT);
  else plan = fftwf_plan_dft_2d(request.height, request.width, out, out, FFTW_BACKWARD, FFTW_ESTIMATE);
  return plan;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) std::int32_t tempolux_fourier(const FourierRequest* request) {
  if (request->abi != tempolux::kFourierAbi) return tempolux::fourier_bad_version;
  const fftwf_plan plan = plan_for(*request);
  if (!plan) return tempolux::fourier_no_memory;
  auto* out = reinterpret_cast<fftwf_complex*>(request->out);
  if (request->kind == tempolux::fourier_forward) fftwf_execute_dft_r2c(plan, request->in, out);
  else fftwf_execute_dft(plan, out, out);
  return tempolux::fourier_ok;
}
