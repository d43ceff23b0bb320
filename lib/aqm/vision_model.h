// lib/aqm/vision_model.h -- Daly's visible differences predictor as formulas: the eye's sensitivity by frequency and
// speed.
//
// Sources of the constants: docs/methods/vision.md. Frequencies are in cycles per degree (cpd) for the eye and in
// cycles per pixel (c/px) for the picture; pixels per degree (ppd) convert between them.
#pragma once

namespace tempolux::vision {

/// Behaviour of the eyes while objects move across the display.
enum class Gaze {
  track,  ///< they follow moving objects, with a gain of .82 and up to 80 deg/s [Daly 1998]
  fixed   ///< they look at one place
};

/// Slowest motion of an image across the retina, deg/s: resting eyes drift.
inline constexpr double kDriftSpeed = 0.15;

/// Signed speed across the retina, deg/s, of a tracked object that moves across the display at `speed` >= 0 deg/s: v -
/// min(.82 v + .15, 80). Negative where the drift is faster than the object.
double tracked_retinal_speed(double speed);

/// The speed at which sensitivity is evaluated: |tracked_retinal_speed| or the speed itself, at least kDriftSpeed.
double retinal_speed(double speed, Gaze gaze);

/// 1 / (Michelson contrast at threshold) of a grating of `frequency` cpd that moves across the retina at `speed` deg/s:
/// Kelly 1979 with the constants of Daly 1998. 0 at frequency 0. speed > 0.
double contrast_sensitivity(double frequency, double speed);

/// The same for a still picture in which eyes look around, from the predictor of Daly 1993. `luminance` in cd/m2 > 0,
/// the picture's area in square degrees, the display's distance in metres. A larger picture shows more periods, which
/// raises the sensitivity to small frequencies. 0 at frequency 0.
double static_contrast_sensitivity(double frequency, double luminance, double area, double distance);

/// Response of a receptor to `luminance` >= 0 cd/m2, from 0 to 100.
double receptor_response(double luminance);
/// Derivative of the response by the logarithm of luminance, at the response `response`.
double response_per_log_luminance(double response);

/// Highest spatial frequency, cpd, that an eye sees (contrast sensitivity 1) in a pattern that moves across the retina
/// at `speed` >= kDriftSpeed deg/s (docs/methods/formulas.md).
double highest_visible_frequency(double speed);
/// Speed of a pattern on the display, deg/s, above which an eye that does not follow the pattern sees at most .9 of the
/// frequencies that a display of this many pixels per degree shows: blur below a pixel is then invisible
/// (docs/methods/formulas.md). 1.41 for 30 pixels per degree. At least kDriftSpeed, at most 80.
double slow_speed(double pixels_per_degree);

// The cortex transform: K = 6 frequency bands, the first five in 6 orientations. Frequencies in c/px.
inline constexpr int kBands = 6, kBaseBand = 6, kOrientations = 6;

/// 1 below 2h/3, 0 above 4h/3, half a period of a cosine between.
double mesa(double frequency, double h);
/// Filter of the base band: a Gaussian, cut off at 1/24 c/px.
double base_filter(double frequency);
/// Filter of band 1 (finest) to 5, or kBaseBand. The bands add up to 1 for frequencies up to 2/3 c/px.
double band_filter(int band, double frequency);
/// The representative frequency of a band: the one that its filter passes best; .5 (Nyquist) for band 1; for the base
/// band sqrt(2) sigma, the root mean square of the Gaussian's frequencies.
double band_frequency(int band);
/// Angle of orientation 1 to 6, radian: -90, -60, .. 60 degrees.
double orientation_angle(int orientation);
/// The weight with which an orientation passes a frequency. `cosine`: of the angle between the orientation and the
/// frequency's direction; its sign does not matter. The weights of a frequency in the six orientations add up to 1.
double fan_filter(double cosine);

/// Slope of masking in a band: the growth of thresholds with the contrast of the masking pattern.
double masking_slope(int band);
/// Factor by which a mask of contrast `contrast` (in thresholds, >= 0) raises the threshold of a difference.
double threshold_elevation(double contrast, double slope);

/// Exponent of the psychometric function.
inline constexpr double kPsychometricSlope = 3.5;
/// A difference of this many thresholds is seen with probability 1/2: (ln 2)^(1/3.5).
inline constexpr double kHalfSeen = 0.90059;
/// 1 - exp(-sum) of the sum of (difference / threshold)^kPsychometricSlope over all channels.
double detection_probability(double sum);
/// A difference in a pixel counts as seen above this probability.
inline constexpr double kSeenProbability = 0.75;
/// Differences of luminance below this, cd/m2, count as none.
inline constexpr double kLeastDifference = 1e-4;

}  // namespace tempolux::vision
