//! The three directions at the grasp. z is up made orthogonal to the motion, and the hinge axis
//! is opening × hinge, so neither pair may be parallel.

use super::Rules;

/// Up must be at least this far from the line of motion.
const UP_FROM_MOTION_DEG: f64 = 20.0;
/// The hinge may be this far from a right angle to the motion.
const HINGE_FROM_RIGHT_ANGLE_DEG: f64 = 5.0;

type Vector = [f64; 3];

pub(super) fn check(rules: &mut Rules<'_>) {
    let opening = direction(rules, "joint.opening_direction");
    let hinge = direction(rules, "joint.hinge_direction");
    let up = direction(rules, "joint.up_direction");
    if let (Some(opening), Some(up)) = (opening, up) {
        up_from_motion(rules, opening, up);
    }
    if let (Some(opening), Some(hinge)) = (opening, hinge) {
        hinge_across_motion(rules, opening, hinge);
    }
}

/// The unit vector of a key; a fault where it has no direction.
fn direction(rules: &mut Rules<'_>, key: &str) -> Option<Vector> {
    let vector = rules.numbers::<3>(key)?;
    let unit = normalized(vector);
    if unit.is_none() {
        rules.fault(
            key,
            format!("`{key}` is {}, which points nowhere", written(vector)),
            "write a vector in tool axes at the grasp, such as [0.0, 0.0, -1.0]",
        );
    }
    unit
}

fn up_from_motion(rules: &mut Rules<'_>, opening: Vector, up: Vector) {
    let angle = angle_deg(opening, up);
    let from_line = angle.min(180.0 - angle);
    if from_line >= UP_FROM_MOTION_DEG {
        return;
    }
    let nearest = across(up, opening).unwrap_or_else(|| any_across(opening));
    rules.fault(
        "joint.up_direction",
        format!(
            "`joint.up_direction` is {from_line:.1}° from the line of motion (opening_direction {}); it must be {UP_FROM_MOTION_DEG}° or more, or f_z and f_n cannot be told apart",
            written(opening)
        ),
        format!("the nearest direction across the motion is up_direction = {}; check which way the tool is turned", written(nearest)),
    );
}

fn hinge_across_motion(rules: &mut Rules<'_>, opening: Vector, hinge: Vector) {
    let angle = angle_deg(opening, hinge);
    if (angle - 90.0).abs() <= HINGE_FROM_RIGHT_ANGLE_DEG {
        return;
    }
    let nearest = across(hinge, opening).unwrap_or_else(|| any_across(opening));
    rules.fault(
        "joint.hinge_direction",
        format!(
            "`joint.hinge_direction` is {angle:.1}° from opening_direction {}; a handle on a hinge moves at 90° to it (up to {HINGE_FROM_RIGHT_ANGLE_DEG}° off are taken)",
            written(opening)
        ),
        format!("the nearest direction across the motion is hinge_direction = {}", written(nearest)),
    );
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Divides by the largest component first, so that neither huge nor tiny vectors lose their
/// direction.
fn normalized(vector: Vector) -> Option<Vector> {
    let largest = vector
        .iter()
        .fold(0.0_f64, |largest, part| largest.max(part.abs()));
    if largest <= 0.0 {
        return None;
    }
    let scaled = vector.map(|part| part / largest);
    let length = dot(scaled, scaled).sqrt();
    Some(scaled.map(|part| part / length))
}

/// Angle between two unit vectors.
fn angle_deg(a: Vector, b: Vector) -> f64 {
    dot(a, b).clamp(-1.0, 1.0).acos().to_degrees()
}

/// The part of `vector` across the unit vector `line`, normalised; `None` where there is none to
/// speak of.
fn across(vector: Vector, line: Vector) -> Option<Vector> {
    let along = dot(vector, line);
    let part = [0, 1, 2].map(|axis| vector[axis] - along * line[axis]);
    (dot(part, part) > 1e-12)
        .then(|| normalized(part))
        .flatten()
}

/// Some unit vector across the unit vector `line`: from the axis that is farthest from it.
fn any_across(line: Vector) -> Vector {
    let farthest = (0..3)
        .min_by(|a, b| line[*a].abs().total_cmp(&line[*b].abs()))
        .unwrap_or_default();
    let mut axis = [0.0; 3];
    axis[farthest] = 1.0;
    across(axis, line).unwrap_or(axis)
}

/// As it would stand in the file, to three digits and without negative zeros.
fn written(vector: Vector) -> String {
    let [x, y, z] = vector.map(|part| (part * 1000.0).round() / 1000.0 + 0.0);
    format!("[{x:?}, {y:?}, {z:?}]")
}
