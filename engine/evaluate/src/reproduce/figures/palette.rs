//! Colours of methods: apart in hue and in lightness.

use pubs_draw::RGBColor;

/// Rows of Table I with PuBS under the shield second.
pub(super) const METHODS: [RGBColor; 5] = [
    RGBColor(0x08, 0x30, 0x6b),
    RGBColor(0x6b, 0xae, 0xd6),
    RGBColor(0xe6, 0x9f, 0x00),
    RGBColor(0xb3, 0x4a, 0x00),
    RGBColor(0x7a, 0x7a, 0x7a),
];

/// PuBS, SARSOP, QMDP.
pub(super) const LINES: [RGBColor; 3] = [
    RGBColor(0x08, 0x30, 0x6b),
    RGBColor(0xb3, 0x4a, 0x00),
    RGBColor(0x7a, 0x7a, 0x7a),
];
