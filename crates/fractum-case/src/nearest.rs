//! Suggestions for misspelt names.

/// Longest name worth comparing.
const LONGEST: usize = 64;

/// Shortest name that counts as the beginning of another.
const BEGINNING: usize = 3;

/// What other programs and books call a thing, and its name here.
const CALLED: [(&[&str], &str); 15] = [
    (&["dt", "timestep", "delta_t", "fixed_step", "time_increment", "increment"], "step"),
    (&["t_end", "end_time", "duration", "total_time", "stop_time", "tmax", "t_max"], "end"),
    (&["cfl", "courant", "scale_factor", "safety_factor"], "safety"),
    (&["e", "young", "youngs_modulus", "elastic_modulus", "modulus"], "young_modulus"),
    (&["nu", "poisson", "poissons_ratio"], "poisson_ratio"),
    (&["rho", "mass_density"], "density"),
    (&["ft", "f_t", "sigma_c", "strength", "tension_strength", "yield_stress"], "tensile_strength"),
    (&["fc", "f_c", "ucs", "compression_strength"], "compressive_strength"),
    (&["gf", "g_f", "gc", "g_c"], "fracture_energy"),
    (&["mu", "friction_coefficient"], "friction"),
    (&["cor", "e_n", "coefficient_of_restitution"], "restitution"),
    (&["cp", "c_p", "specific_heat"], "heat_capacity"),
    (&["cte", "alpha", "thermal_expansion"], "expansion"),
    (&["k", "lambda", "thermal_conductivity"], "conductivity"),
    (&["fixed", "bc", "constraint"], "fix"),
];

/// The candidate that resembles `name` most, if one does: at most a third of its letters differ, upper and lower case
/// aside, or else one of both begins the other. The first of several equals wins. What other programs call it comes before that.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if name.chars().count() > LONGEST {
        return None;
    }
    let plain = |text: &str| text.to_lowercase().replace(['-', ' '], "_");
    let name = plain(name);
    let called = CALLED.iter().find(|(names, _)| names.contains(&name.as_str())).map(|(_, here)| *here);
    let distance = |candidate: &str| strsim::osa_distance(&name, &plain(candidate));
    let allowed = |candidate: &str| (candidate.chars().count().max(name.chars().count()) / 3).max(1);
    let begins = |candidate: &str| {
        let candidate = plain(candidate);
        let length = candidate.len().min(name.len());
        length >= BEGINNING && (candidate.starts_with(&name) || name.starts_with(&candidate))
    };
    let close = candidates.into_iter().filter(|candidate| candidate.len() <= 4 * LONGEST);
    let close = close.map(|candidate| (distance(candidate), candidate));
    // What differs in few letters comes before what only begins alike.
    let rank = |&(distance, candidate): &(usize, &str)| match distance <= allowed(candidate) {
        _ if called == Some(candidate) => Some((0, 0)),
        true => Some((0, distance)),
        false => begins(candidate).then_some((1, distance)),
    };
    let ranked = close.filter_map(|pair| Some((rank(&pair)?, pair.1)));
    ranked.min_by_key(|(rank, _)| *rank).map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn close_names_are_found_and_strange_ones_are_not() {
        let names = ["density", "young_modulus", "poisson_ratio"];
        assert_eq!(nearest("densty", names), Some("density"));
        assert_eq!(nearest("young-modulus", names), Some("young_modulus"));
        assert_eq!(nearest("Poisson_ration", names), Some("poisson_ratio"));
        assert_eq!(nearest("viscosity", names), None);
        assert_eq!(nearest("fixed", ["name", "fix", "fix_rotation"]), Some("fix"));
        assert_eq!(nearest("poisson", names), Some("poisson_ratio"));
        assert_eq!(nearest("E", names), Some("young_modulus"));
        assert_eq!(nearest("rho", names), Some("density"));
        assert_eq!(nearest("fixed_step", ["time_step", "step"]), Some("step"));
        assert_eq!(nearest("dt", names), None);
        assert_eq!(nearest(&"x".repeat(1000), names), None);
    }
}
