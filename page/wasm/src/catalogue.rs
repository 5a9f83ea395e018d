//! The catalogue of soils, with the keys of soil files, and the gravities that have a name.

use grouser_terra::{catalogue, gravity_of};
use serde_json::{Value, json};

/// Every soil; null stands for a number that the source does not give.
pub(crate) fn soils() -> Value {
    let soils: Vec<Value> = catalogue::entries()
        .iter()
        .map(|entry| {
            json!({
                "key": entry.key,
                "name": entry.name,
                "source": entry.source,
                "note": entry.note,
                "n": entry.n,
                "n_1": entry.n_1,
                "k_c_kn_per_m_n1": entry.k_c_kn,
                "k_phi_kn_per_m_n2": entry.k_phi_kn,
                "cohesion_kpa": entry.cohesion_kpa,
                "phi_deg": entry.phi_deg,
                "k_shear_m": entry.k_shear,
                "c_1": entry.c_1,
                "c_2": entry.c_2,
            })
        })
        .collect();
    let gravity: Vec<Value> = ["earth", "mars", "moon"]
        .iter()
        .filter_map(|body| Some(json!({ "body": body, "gravity_m_per_s2": gravity_of(body)? })))
        .collect();
    json!({ "soils": soils, "gravity": gravity })
}
