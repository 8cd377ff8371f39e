//! From the sheet to paper.

/// Gives a finished SVG of this size (1/300 inch) its size in millimetres, so that it prints so.
pub fn printed(svg: &str, [width, height]: [i32; 2]) -> String {
    let millimetres = |length: i32| (f64::from(length) / 300.0 * 25.4).round();
    svg.replacen(
        &format!("width=\"{width}\" height=\"{height}\""),
        &format!(
            "width=\"{}mm\" height=\"{}mm\"",
            millimetres(width),
            millimetres(height)
        ),
        1,
    )
}
