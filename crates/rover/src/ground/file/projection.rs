//! How long a metre of projected coordinates is on the ground.

use std::f64::consts::FRAC_PI_2;

use grouser_real::Real;

use super::epsg::TRUE_TO_SCALE;
use super::georeference::{Georeference, USER_DEFINED};
use crate::terrain_fault::NoCell;

/// GeoTIFF's keys of a projection.
pub(super) const PROJECTED_SYSTEM_KEY: u32 = 3072;
pub(super) const METHOD_KEY: u32 = 3075;
pub(super) const STANDARD_PARALLEL_KEY: u32 = 3078;
pub(super) const ORIGIN_LATITUDE_KEY: u32 = 3081;
pub(super) const FALSE_EASTING_KEY: u32 = 3082;
pub(super) const FALSE_NORTHING_KEY: u32 = 3083;
const CENTRE_LATITUDE_KEY: u32 = 3089;
pub(super) const SCALE_KEY: u32 = 3092;
pub(super) const SEMI_MAJOR_AXIS_KEY: u32 = 2057;
const ANGULAR_UNIT_KEY: u32 = 2054;
/// EPSG's code of the degree.
const DEGREE: u32 = 9102;
/// Semi-major axis of WGS 84, m; other ellipsoids of the Earth differ by less than 1e-4 of it.
const EARTH_RADIUS_M: f64 = 6_378_137.0;
/// The largest relative difference of lengths that is read: 0.073 deg of a slope of 10 deg.
const MAX_SCALE_ERROR: f64 = 0.0075;
/// 1 - e² of WGS 84: the curvature of a meridian at the equator, where a sphere's Mercator has none of it.
const MERIDIAN_SHARE: f64 = 0.99331;

/// Projections whose scale has a closed form on the sphere; close to 1 it differs from the ellipsoid's by less than
/// 0.4 %. Lengths in m, latitudes in rad.
///
/// Source: Snyder (1987), Map Projections: A Working Manual, USGS Professional Paper 1395, the chapters of each.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Method {
    TransverseMercator { k_0: f64, easting: f64 },
    Mercator { k_0: f64, northing: f64 },
    PolarStereographic { k_0: f64, origin: [f64; 2] },
    Equirectangular { parallel: f64, from: [f64; 2] },
}

impl Method {
    /// The smallest and the largest length of coordinates over that on the ground, at a place.
    fn scales(self, radius: f64, [x, y]: [f64; 2]) -> [f64; 2] {
        match self {
            Self::TransverseMercator { k_0, easting } => {
                let off = (x - easting) / (k_0 * radius);
                [k_0 * Real::cosh(off); 2]
            }
            Self::Mercator { k_0, northing } => {
                let k = k_0 * Real::cosh((y - northing) / (k_0 * radius));
                [k, k]
            }
            Self::PolarStereographic { k_0, origin } => {
                let off = Real::hypot(x - origin[0], y - origin[1]) / (2.0 * radius * k_0);
                [k_0 * (1.0 + off * off); 2]
            }
            Self::Equirectangular { parallel, from } => {
                let latitude = (y - from[1]) / radius + from[0];
                let k = Real::cos(parallel) / Real::cos(latitude);
                [k.min(1.0), k.max(1.0)]
            }
        }
    }

    /// By GeoTIFF's code of a method and its parameters.
    fn from_keys(code: u32, keys: &Georeference) -> Option<Self> {
        let number = |key, default| keys.number(key).unwrap_or(default);
        let k_0 = number(SCALE_KEY, 1.0);
        let [easting, northing] =
            [FALSE_EASTING_KEY, FALSE_NORTHING_KEY].map(|key| number(key, 0.0));
        let parallel = number(STANDARD_PARALLEL_KEY, 0.0).to_radians();
        let latitude = number(ORIGIN_LATITUDE_KEY, 0.0).to_radians();
        Some(match code {
            1 => Self::TransverseMercator { k_0, easting },
            7 => Self::Mercator {
                k_0: k_0 * Real::cos(parallel),
                northing,
            },
            15 => Self::polar(k_0, latitude, [easting, northing]),
            17 => Self::Equirectangular {
                parallel,
                from: [
                    number(CENTRE_LATITUDE_KEY, number(ORIGIN_LATITUDE_KEY, 0.0)).to_radians(),
                    northing,
                ],
            },
            _ => return None,
        })
    }

    /// True to scale at a latitude, or, at the pole, by `k_0`.
    fn polar(k_0: f64, latitude: f64, origin: [f64; 2]) -> Self {
        let at_latitude = 0.5 * (1.0 + Real::sin(latitude.abs().min(FRAC_PI_2)));
        Self::PolarStereographic {
            k_0: k_0 * at_latitude,
            origin,
        }
    }

    /// Systems of EPSG whose scale depends on the place so much that it is computed there.
    fn from_epsg(code: u32) -> Option<Self> {
        let polar = |latitude: f64| Some(Self::polar(1.0, latitude.to_radians(), [0.0; 2]));
        match code {
            // UTM: WGS 84, ETRS89, NAD83
            32_601..=32_660 | 32_701..=32_760 | 25_828..=25_838 | 26_901..=26_923 => {
                Some(Self::TransverseMercator {
                    k_0: 0.9996,
                    easting: 500e3,
                })
            }
            3413 | 3976 => polar(70.0),
            3031 | 3995 => polar(71.0),
            32_661 | 32_761 | 5041 | 5042 => Some(Self::polar(0.994, FRAC_PI_2, [2e6; 2])),
            3857 | 3785 => Some(Self::Mercator {
                k_0: 1.0,
                northing: 0.0,
            }),
            4087 | 32_662 => Some(Self::Equirectangular {
                parallel: 0.0,
                from: [0.0; 2],
            }),
            _ => None,
        }
    }
}

/// Refuses an image of `size` columns and rows whose coordinates are not true to scale on the ground.
pub(super) fn check_scale(keys: &Georeference, size: (u32, u32)) -> Result<(), NoCell> {
    let system = keys
        .key(PROJECTED_SYSTEM_KEY)
        .filter(|code| *code != USER_DEFINED);
    let (tag, code, method) = match (system, keys.key(METHOD_KEY)) {
        (Some(code), _) => match Method::from_epsg(code) {
            Some(method) => ("ProjectedCRSGeoKey (3072)", code, method),
            None if is_listed(&TRUE_TO_SCALE, code) => return Ok(()),
            None => return Err(NoCell::System { code }),
        },
        (None, Some(code)) => {
            let degrees = matches!(keys.key(ANGULAR_UNIT_KEY), None | Some(DEGREE));
            match Method::from_keys(code, keys).filter(|_| degrees) {
                Some(method) => ("ProjMethodGeoKey (3075)", code, method),
                None => return Err(NoCell::Method { code }),
            }
        }
        (None, None) => return Err(NoCell::NoSystem),
    };
    let radius = keys.number(SEMI_MAJOR_AXIS_KEY).unwrap_or(EARTH_RADIUS_M);
    let [right, bottom] = [size.0, size.1].map(|cells| cells.saturating_sub(1));
    let corners = [(0, 0), (right, 0), (0, bottom), (right, bottom)];
    let places = corners.map(|(column, row)| keys.centre(column, row));
    let mut range = [f64::INFINITY, 0.0_f64];
    for place in places {
        let Some(place) = place else {
            return Err(NoCell::NoPlace);
        };
        let [low, high] = method.scales(radius, place);
        // the coordinates of a sphere, on an ellipsoid: it counts where the two are compared along a meridian
        let on_ellipsoid = matches!(system, Some(3857 | 3785));
        let high = if on_ellipsoid {
            high / MERIDIAN_SHARE
        } else {
            high
        };
        range = [range[0].min(low), range[1].max(high)];
    }
    let [low, high] = range;
    // a NaN is no scale
    if low >= 1.0 - MAX_SCALE_ERROR && high <= 1.0 + MAX_SCALE_ERROR {
        return Ok(());
    }
    Err(NoCell::Scale {
        tag,
        code,
        low,
        high,
    })
}

/// Is a code in one of the ranges, which are given by their first and last codes?
pub(super) fn is_listed(ranges: &[u16], code: u32) -> bool {
    let within = |range: &[u16]| (u32::from(range[0])..=range[1].into()).contains(&code);
    ranges.chunks_exact(2).any(within)
}
