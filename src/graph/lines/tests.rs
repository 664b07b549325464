use super::*;
use crate::streamline::STEP;

/// A straight line of some points from a place, `step` apart.
fn line(from: Point, step: Vec2, count: usize) -> Line {
    let points: Vec<Point> = (0..count).map(|k| from + step * k as f64).collect();
    Line { widths: vec![2.0; count], points, closed: false, ends: [EndState::Open, EndState::RanIn] }
}

/// A circle.
fn ring(radius: f64) -> Line {
    let count = (std::f64::consts::TAU * radius / STEP) as usize;
    let points: Vec<Point> =
        (0..count).map(|k| (Vec2::from_angle(STEP / radius * k as f64) * radius).to_point()).collect();
    Line { widths: vec![2.0; count], points, closed: true, ends: [EndState::Open; 2] }
}

fn cross() -> Lines {
    let (x, y) = (Vec2::new(STEP, 0.0), Vec2::new(0.0, STEP));
    vec![line(Point::new(0.0, 10.2), x, 41), line(Point::new(10.1, 0.0), y, 41)].into()
}

#[test]
fn cut_lines_have_all_of_their_points_and_keep_their_outer_ends() {
    for at in [0.0, 0.4, 1.0, 20.0, 39.6, 40.0, 60.0] {
        let mut lines = cross();
        let before = lines[0].clone();
        assert_eq!(lines.cut(&[Place { line: 0, at }]), 1);
        let parts = &lines[..lines.len() - 1];
        assert_eq!((parts[0].ends[0], parts[parts.len() - 1].ends[1]), (EndState::Open, EndState::RanIn));
        assert!(parts.windows(2).all(|p| (p[0].ends[1], p[1].ends[0]) == (EndState::Parted, EndState::Parted)));
        // Parts share the point at which they were parted.
        let count: usize = parts.iter().map(|p| p.points.len()).sum();
        assert_eq!(count, before.points.len() + parts.len() - 1, "{at}");
        assert_eq!(lines[lines.len() - 1], cross()[1]);
    }
}

#[test]
fn a_ring_that_is_cut_once_is_one_open_line_all_around() {
    let n = ring(12.0).points.len();
    for at in [0, 1, n / 2, n - 1] {
        let mut lines: Lines = vec![ring(12.0)].into();
        lines.cut(&[Place { line: 0, at: at as f64 }]);
        assert_eq!((lines.len(), lines[0].points.len(), lines[0].closed), (1, n + 1, false));
        assert_eq!(lines[0].points[0], lines[0].points[n]);
        assert_eq!(lines[0].ends, [EndState::Parted; 2]);
    }
    for count in 2..6 {
        let mut lines: Lines = vec![ring(12.0)].into();
        let places: Vec<Place> = (0..count).map(|k| Place { line: 0, at: (k * n / count) as f64 }).collect();
        lines.cut(&places);
        assert_eq!(lines.len(), count);
    }
}

#[test]
fn what_was_found_is_forgotten_with_an_edit() {
    let mut lines = cross();
    let ahead = Segment::new((9.0, 3.2), (11.0, 3.2));
    assert_eq!(lines.crossings(ahead).len(), 1);
    assert_eq!(lines.near(Point::new(10.1, 3.2), 0.2)[0].0.line, 1);
    lines.shorten(1, 0, 10, EndState::Lifted);
    assert!(lines.crossings(ahead).is_empty() && lines.near(Point::new(10.1, 3.2), 0.2).is_empty());
    assert_eq!(lines[1].ends, [EndState::Lifted, EndState::RanIn]);
    lines.edit().pop();
    assert!(lines.crossings(Segment::new((9.0, 9.0), (11.0, 9.0))).is_empty());
}

#[test]
fn places_are_found_where_lines_are_and_the_nearest_first() {
    let lines = cross();
    for k in 0..20 {
        let p = Point::new(0.7 * f64::from(k), 9.6);
        let near = lines.near(p, 3.0);
        assert!(near.windows(2).all(|w| w[0].2 <= w[1].2));
        for (place, foot, distance) in near {
            assert!((lines.point(place) - foot).hypot() < 1e-9 && ((foot - p).hypot() - distance).abs() < 1e-9);
        }
    }
    let found = lines.crossings(lines[0].piece(20));
    assert!(found.iter().any(|(place, ..)| place.line == 1), "{found:?}");
}

#[test]
fn a_lead_replaces_the_last_points_of_an_end() {
    for side in [0, 1] {
        let mut lines = cross();
        let tip = lines[0].at_end(side, 0);
        let points: Vec<Point> = (0..4).map(|k| tip + Vec2::new(0.0, f64::from(k))).collect();
        lines.lead(0, side, Lead { points: points.clone(), replaced: 6 });
        let line = &lines[0];
        assert_eq!(line.points.len(), 41 - 6 + 4);
        for (k, point) in points.iter().enumerate() {
            assert_eq!(line.at_end(side, k), *point);
            assert!(!line.is_alone(line.inwards(side, k)));
        }
        assert_eq!(line.ends[side], EndState::Led);
        assert_eq!(line.ends[1 - side], cross()[0].ends[1 - side]);
    }
}

#[test]
fn where_no_width_is_known_it_is_the_typical_one() {
    let mut lines = cross();
    let place = Place { line: 0, at: 20.0 };
    assert_eq!(lines.width(place, 5.0), 2.0);
    lines.edit()[0].widths.fill(f64::NAN);
    assert_eq!(lines.width(place, 5.0), 5.0);
}
