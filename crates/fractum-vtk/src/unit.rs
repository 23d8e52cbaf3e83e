//! Units of the fields that frames hold.

/// Unit of an array by its name; none for pure numbers and names that are not known.
pub(super) fn unit_of(name: &str) -> Option<&'static str> {
    Some(match name {
        "Points" | "displacement" | "radius" | "thickness" | "opening" | "overlap" => "m",
        "velocity" => "m/s",
        "spin" => "rad/s",
        "rotation" => "rad",
        "mass" => "kg",
        "area" => "m^2",
        "time" | "TimeValue" => "s",
        "stress" | "first_principal_stress" | "von_mises_stress" | "principal_stresses" | "pressure" => "Pa",
        "reaction" | "axial_force" | "normal_force" | "tangential_force" | "force" | "load" => "N",
        "elastic_energy" | "energy" => "J",
        "temperature" => "K",
        "density" => "kg/m^3",
        _ => return None,
    })
}
