//! What the L-BFGS-B of scipy reaches on the standard problems, and on a GPLVM.
//!
//! Printed by `python3 crates/sinew-studies/peers/scipy_lbfgs.py`, which holds the residuals a second time and takes their derivatives by complex steps.

/// Name and dimension, value at the start, value reached, evaluations.
pub type Row = (&'static str, f64, f64, usize);

// scipy 1.17.1, numpy 2.4.6, Python 3.11.7
pub const ROWS: [Row; 36] = [
    ("2 Freudenstein–Roth, n = 2", 400.5, 48.984253679240034, 60),
    ("3 Powell badly scaled, n = 2", 1.1352617173483783, 1.2717738479910212e-07, 103),
    ("4 Brown badly scaled, n = 2", 999998000003.0, 0.0, 28),
    ("5 Beale, n = 2", 14.203125, 1.232595164407831e-30, 19),
    ("6 Jennrich–Sampson, n = 2", 4171.306161960492, 214.3418255179205, 24),
    ("7 helical valley, n = 3", 2500.0, 2.463810228285105e-30, 37),
    ("8 Bard, n = 3", 41.68169586167801, 0.008214877306578976, 29),
    ("9 Gaussian, n = 3", 3.888106991166885e-06, 1.127932769618726e-08, 53),
    ("10 Meyer, n = 3", 1693607809.4361455, 104.88076832301437, 520),
    ("11 Gulf research, n = 3", 12.11070582556949, 3.579331596300397e-27, 61),
    ("12 box three-dimensional, n = 3", 1031.1538106093983, 2.0828546949936412e-23, 41),
    ("14 Wood, n = 4", 19192.0, 3.8099023493780294e-28, 123),
    ("15 Kowalik–Osborne, n = 4", 0.005313172272108539, 0.0003075056038492379, 39),
    ("16 Brown–Dennis, n = 4", 7926693.336997433, 85822.20162635628, 49),
    ("18 Biggs EXP6, n = 6", 0.7790700756559702, 0.0056556499254999375, 77),
    ("1 Rosenbrock, n = 2", 24.199999999999996, 2.180460845837453e-29, 47),
    ("13 Powell singular, n = 4", 215.00000000000003, 4.933650665960713e-25, 98),
    ("20 Watson, n = 6", 30.0, 0.0022876700535523833, 106),
    ("20 Watson, n = 9", 30.0, 1.3997601381092683e-06, 431),
    ("21 extended Rosenbrock, n = 100", 1209.9999999999995, 2.347477490614714e-27, 50),
    ("22 extended Powell singular, n = 100", 5375.0, 5.7867243713050075e-24, 99),
    ("23 penalty I, n = 4", 885.06264, 2.2499775008999372e-05, 74),
    ("23 penalty I, n = 10", 148032.56535, 7.08765146709037e-05, 73),
    ("24 penalty II, n = 4", 2.340008805463025, 9.376293007355437e-06, 404),
    ("24 penalty II, n = 10", 162.65277656596712, 0.00029366053745856507, 390),
    ("25 variably dimensioned, n = 10", 2198551.1625, 3.2047474274603605e-30, 21),
    ("26 trigonometric, n = 10", 0.0070757594662228356, 2.7950561218777656e-05, 65),
    ("27 Brown almost linear, n = 10", 273.2480478286743, 2.0043821614114655e-26, 22),
    ("28 discrete boundary value, n = 10", 0.0007885191012648201, 5.748294935428344e-26, 74),
    ("29 discrete integral equation, n = 10", 0.06341684157945263, 2.726703174092995e-26, 11),
    ("30 Broyden tridiagonal, n = 10", 21.0, 1.7911579891108836e-27, 36),
    ("31 Broyden banded, n = 10", 360.0, 1.4112174630299695e-27, 22),
    ("32 linear of full rank, n = 10", 50.0, 10.0, 3),
    ("33 linear of rank one, n = 10", 8658670.0, 4.634146341463414, 4),
    ("35 Chebyquad, n = 8", 0.038617698285930285, 0.0035168737256779242, 53),
    ("35 Chebyquad, n = 9", 0.028882980288225987, 1.6678993728788832e-26, 62),
];

/// A GPLVM of 30 rows of six columns from three starts: size of the spiral of latents that it starts at, value there, value reached, evaluations.
pub const MODELS: [(f64, f64, f64, usize); 3] = [
    (0.5, 63.12452599756537, -164.20467141067704, 1618),
    (1.0, 100.45772733383876, -136.4443979306505, 3170),
    (2.0, 233.54815398834836, -134.22000449801482, 3266),
];
