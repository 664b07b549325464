//! The pattern of a dashed line starts where its trail does. The centreline of a closed one may start elsewhere and run the
//! other way around.

use super::outline::tangent;
use crate::drawing::{Centreline, Dashes};
use crate::graph::TrailPoint;
use kurbo::{ParamCurve, ParamCurveArclen, ParamCurveNearest, PathSeg};

const ACCURACY: f64 = 1e-3;

/// The pattern of a walk, seen from the start of its centreline.
pub(super) fn along(dashes: Dashes, walk: &[TrailPoint], centreline: &Centreline) -> Dashes {
    let [first, second, ..] = walk else { return dashes };
    let pieces: Vec<PathSeg> = centreline.to_path().segments().collect();
    let nearest = |piece: &PathSeg| piece.nearest(first.point, ACCURACY);
    let nearest = pieces.iter().map(nearest).enumerate();
    let Some((k, at)) = nearest.min_by(|a, b| a.1.distance_sq.total_cmp(&b.1.distance_sq)) else { return dashes };
    let before: f64 = pieces[..k].iter().map(|piece| piece.arclen(ACCURACY)).sum();
    let start = before + pieces[k].subsegment(0.0..at.t).arclen(ACCURACY);
    let onwards = tangent(&pieces[k], at.t).is_none_or(|t| t.dot(second.point - first.point) >= 0.0);
    if onwards {
        Dashes { offset: (dashes.offset - start).rem_euclid(dashes.dash + dashes.gap), ..dashes }
    } else {
        dashes.reversed(start)
    }
}
