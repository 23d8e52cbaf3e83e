//! Properties of the flow of liquids between walls.

use fractum_kernels::liquid::{CubicLaw, leaked};

use super::draw::{Draw, Held, hold};

/// Smooth walls follow the cubic law, rough ones let less through, wider slits more; the slope is that of the flow; closed walls are tight.
pub(crate) fn flow(draw: &mut Draw) -> Held {
    let law = CubicLaw { viscosity: draw.over_decades(1e-5, 1e3), roughness: draw.over_decades(1e-9, 1e-2) };
    let smooth = CubicLaw { roughness: 0.0, ..law };
    let aperture = draw.over_decades(1e-8, 1e-1);
    let [flow, slope] = law.transmissivity(aperture);
    let cubic = aperture * aperture * aperture / (12.0 * law.viscosity);
    hold((smooth.transmissivity(aperture)[0] / cubic - 1.0).abs() < 1e-12, || "smooth walls".to_owned())?;
    hold(flow > 0.0 && flow < cubic, || format!("{flow:e} of {cubic:e}"))?;
    let step = 1e-5 * aperture;
    let difference = (law.transmissivity(aperture + step)[0] - law.transmissivity(aperture - step)[0]) / (2.0 * step);
    hold((slope / difference - 1.0).abs() < 1e-7, || format!("slope {slope:e}, not {difference:e}"))?;
    let wide = CubicLaw { roughness: 1e-9 * aperture, ..law };
    hold((wide.transmissivity(aperture)[0] / cubic - 1.0).abs() < 1e-11, || "little roughness".to_owned())?;
    hold(law.transmissivity(-aperture) == [0.0; 2] && law.transmissivity(0.0) == [0.0; 2], || "closed".to_owned())
}

/// Both walls take √t: nothing at first, twice as much in four times the time, at the rate 2 C/√t.
pub(crate) fn leak(draw: &mut Draw) -> Held {
    let (coefficient, age) = (draw.over_decades(1e-9, 1e-2), draw.over_decades(1e-6, 1e6));
    let lost = leaked(coefficient, age);
    hold(leaked(coefficient, 0.0) == 0.0, || "something at once".to_owned())?;
    hold((leaked(coefficient, 4.0 * age) / lost - 2.0).abs() < 1e-12, || "not √t".to_owned())?;
    let rate = (leaked(coefficient, age * (1.0 + 1e-6)) - lost) / (1e-6 * age);
    hold((rate * age.sqrt() / (2.0 * coefficient) - 1.0).abs() < 1e-5, || format!("rate {rate:e}"))
}
