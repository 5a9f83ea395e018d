//! Gravity on the bodies that rovers drive on.

/// Standard gravity of the Earth, m/s². Source: the definition of 1901 (CGPM).
pub const EARTH_GRAVITY_M_PER_S2: f64 = 9.806_65;

/// Gravity at the Moon's surface, m/s². Source: NASA's Moon fact sheet.
pub const MOON_GRAVITY_M_PER_S2: f64 = 1.62;

/// Gravity at the surface of Mars, m/s². Source: NASA's Mars fact sheet, 3.71 at the equator.
pub const MARS_GRAVITY_M_PER_S2: f64 = 3.71;

/// The gravity of `earth`, `moon` or `mars`, m/s²; `None` for another name.
///
/// It turns a mass into a load. It does not change the numbers of a soil, which hold for the gravity under which they
/// were measured. The unit weight γ = ρ g is proportional to gravity by its definition: give that of the place. For the
/// other numbers no law is applied. Sources: Kobayashi et al., J. Terramechanics 47 (2010), where the sinkage of a
/// wheel of constant mass does not change with gravity and its slip rises as gravity falls; Niksirat, Daca & Skonieczny,
/// Int. J. Robotics Research 39 (2020), where under a constant load a wheel loses 20 % of its traction under lunar
/// gravity and 5 to 10 % under Martian gravity, and sinks deeper.
///
/// ```
/// assert_eq!(grouser_terra::gravity_of("moon"), Some(1.62));
/// assert_eq!(grouser_terra::gravity_of("venus"), None);
/// ```
#[must_use]
pub fn gravity_of(body: &str) -> Option<f64> {
    match body {
        "earth" => Some(EARTH_GRAVITY_M_PER_S2),
        "moon" => Some(MOON_GRAVITY_M_PER_S2),
        "mars" => Some(MARS_GRAVITY_M_PER_S2),
        _ => None,
    }
}
