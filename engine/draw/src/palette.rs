//! Colours of actions: apart in hue and in lightness.

use crate::RGBColor;

/// Actions by index: stop is dark; then opening is blue and closing orange, light where it is safe
/// or small and strong where it is fast or large.
const ACTIONS: [RGBColor; 8] = [
    RGBColor(0x25, 0x25, 0x25),
    RGBColor(0xb3, 0xd3, 0xec),
    RGBColor(0xfd, 0xd0, 0xa2),
    RGBColor(0x21, 0x71, 0xb5),
    RGBColor(0xe6, 0x55, 0x0d),
    RGBColor(0x74, 0xc4, 0x76),
    RGBColor(0x9e, 0x9a, 0xc8),
    RGBColor(0x00, 0x6d, 0x2c),
];

/// The colour of an action; they repeat where there are more.
pub fn action(index: usize) -> RGBColor {
    ACTIONS[index % ACTIONS.len()]
}
