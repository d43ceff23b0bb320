// lib/aqm/vision_model.h -- Daly's visible differences predictor as formulas: what an eye sees at which
// frequency and speed.
//
// Where each constant comes from: docs/methods/vision.md. Frequencies are in cycles per degree (cpd) where
// the eye matters, in cycles per pixel (c/px) where the picture is taken apart; pixels per degree (ppd) lie
// between the two.
#pragma once

namespace tempolux::vision {

/// What the eyes do while things move across the display.
enum class Gaze {
  track,  ///< they follow what moves, with a gain of .82 and up to 80 deg/s [Daly 1998]
  fixed   ///< they look at one place
};

/// Slowest motion of an image across the retina, deg/s: eyes drift even when they rest.
inline constexpr double kDriftSpeed = 0.15;

/// Motion of an image across the retina, signed, deg/s, of what moves across the display at `speed` >= 0
/// deg/s and is tracked: v - min(.82 v + .15, 80). Negative where drift is faster than what moves.
double tracked_retinal_speed(double speed);

/// What the sensitivity is asked for: |tracked_retinal_speed| or the speed itself, and kDriftSpeed at least.
double retinal_speed(double speed, Gaze gaze);

/// 1 / (Michelson contrast at threshold) of a grating of `frequency` cpd that moves across the retina at
/// `speed` deg/s: Kelly 1979 as Daly fitted it anew in 1998. 0 at frequency 0. speed > 0.
double contrast_sensitivity(double frequency, double speed);

/// The same of a picture that stands still and that eyes look around in: Daly 1993, as his predictor has it.
/// `luminance` in cd/m2 > 0, the picture's area in square degrees, the display's distance in metres. A larger picture
/// shows more periods: low frequencies gain. 0 at frequency 0.
double static_contrast_sensitivity(double frequency, double luminance, double area, double distance);

/// Response of a receptor to `luminance` >= 0 cd/m2, from 0 to 100.
double receptor_response(double luminance);
/// Change of the response per change of the logarithm of luminance, where the response is `response`.
double response_per_log_luminance(double response);

// The cortex transform: K = 6 bands of frequency, the first five in 6 orientations. Frequencies in c/px.
inline constexpr int kBands = 6, kBaseBand = 6, kOrientations = 6;

/// 1 below 2h/3, 0 above 4h/3, half a period of a cosine between.
double mesa(double frequency, double h);
/// The lowest band: a Gaussian cut off at 1/24 c/px.
double base_filter(double frequency);
/// Band 1 (finest) to 5, or kBaseBand. The bands add up to 1 for frequencies up to 2/3 c/px.
double band_filter(int band, double frequency);
/// Frequency that stands for a band: where it lets most through, but Nyquist's .5 for band 1, and sqrt(2)
/// sigma for the base band, the root mean square of the Gaussian's frequencies.
double band_frequency(int band);
/// Angle of orientation 1 to 6, radian: -90, -60, .. 60 degrees.
double orientation_angle(int orientation);
/// Weight of a frequency that lies at an angle whose cosine to the orientation is `cosine`, of either sign.
/// The six add up to 1.
double fan_filter(double cosine);

/// Slope of masking in a band: how fast thresholds rise with the contrast of what hides a difference.
double masking_slope(int band);
/// How many times its threshold contrast a difference must have where a mask has `contrast` (in thresholds,
/// >= 0).
double threshold_elevation(double contrast, double slope);

/// Exponent of the psychometric function.
inline constexpr double kPsychometricSlope = 3.5;
/// A difference of this many thresholds is seen with probability 1/2: (ln 2)^(1/3.5).
inline constexpr double kHalfSeen = 0.90059;
/// 1 - exp(-sum) of the sum of (difference / threshold)^kPsychometricSlope over all channels.
double detection_probability(double sum);
/// A pixel counts as seen to differ above this probability.
inline constexpr double kSeenProbability = 0.75;
/// Differences of luminance below this, cd/m2, are none.
inline constexpr double kLeastDifference = 1e-4;

}  // namespace tempolux::vision
