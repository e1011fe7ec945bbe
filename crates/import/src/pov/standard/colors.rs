//! The colour names: red, green and blue as POV-Ray's documentation and `colors.inc` have them.

use octray_math::DVec3;
use octray_scene::Color;

use crate::pov::value::{Terms, Value};

/// Name and value of every colour.
pub(in crate::pov) fn table() -> impl Iterator<Item = (String, Value)> {
    let plain = COLORS
        .iter()
        .map(|(name, [r, g, b])| ((*name).to_owned(), DVec3::new(*r, *g, *b)));
    // Gray05, Gray10, ... Gray95.
    let grays = (1..20).map(|step| {
        let value = f64::from(step) * 0.05;
        (format!("Gray{:02}", step * 5), DVec3::splat(value))
    });
    let opaque = plain.chain(grays).map(|(name, rgb)| {
        let color = Color::rgb(rgb.x, rgb.y, rgb.z);
        (name, Value::Terms(Terms::color(&color)))
    });
    let clear = Color {
        rgb: DVec3::ONE,
        filter: 1.0,
        transmit: 0.0,
    };
    opaque.chain([("Clear".to_owned(), Value::Terms(Terms::color(&clear)))])
}

const COLORS: [(&str, [f64; 3]); 110] = [
    ("Aquamarine", [0.439216, 0.858824, 0.576471]),
    ("BakersChoc", [0.36, 0.2, 0.09]),
    ("Black", [0.0, 0.0, 0.0]),
    ("Blue", [0.0, 0.0, 1.0]),
    ("BlueViolet", [0.62352, 0.372549, 0.623529]),
    ("Brass", [0.71, 0.65, 0.26]),
    ("BrightGold", [0.85, 0.85, 0.1]),
    ("Bronze", [0.55, 0.47, 0.14]),
    ("Bronze2", [0.65, 0.49, 0.24]),
    ("Brown", [0.647059, 0.164706, 0.164706]),
    ("CadetBlue", [0.372549, 0.623529, 0.623529]),
    ("CoolCopper", [0.85, 0.53, 0.1]),
    ("Copper", [0.72, 0.45, 0.2]),
    ("Coral", [1.0, 0.498039, 0.0]),
    ("CornflowerBlue", [0.258824, 0.258824, 0.435294]),
    ("Cyan", [0.0, 1.0, 1.0]),
    ("DarkBrown", [0.36, 0.25, 0.2]),
    ("DarkGreen", [0.184314, 0.309804, 0.184314]),
    ("DarkOliveGreen", [0.309804, 0.309804, 0.184314]),
    ("DarkOrchid", [0.6, 0.196078, 0.8]),
    ("DarkPurple", [0.53, 0.12, 0.47]),
    ("DarkSlateBlue", [0.119608, 0.137255, 0.556863]),
    ("DarkSlateGray", [0.184314, 0.309804, 0.309804]),
    ("DarkSlateGrey", [0.184314, 0.309804, 0.309804]),
    ("DarkTan", [0.59, 0.41, 0.31]),
    ("DarkTurquoise", [0.439216, 0.576471, 0.858824]),
    ("DarkWood", [0.52, 0.37, 0.26]),
    ("DimGray", [0.329412, 0.329412, 0.329412]),
    ("DimGrey", [0.329412, 0.329412, 0.329412]),
    ("DkGreenCopper", [0.29, 0.46, 0.43]),
    ("DustyRose", [0.52, 0.39, 0.39]),
    ("Feldspar", [0.82, 0.57, 0.46]),
    ("Firebrick", [0.556863, 0.137255, 0.137255]),
    ("Flesh", [0.96, 0.8, 0.69]),
    ("ForestGreen", [0.137255, 0.556863, 0.137255]),
    ("Gold", [0.8, 0.498039, 0.196078]),
    ("Goldenrod", [0.858824, 0.858824, 0.439216]),
    ("Gray", [0.752941, 0.752941, 0.752941]),
    ("Green", [0.0, 1.0, 0.0]),
    ("GreenCopper", [0.32, 0.49, 0.46]),
    ("GreenYellow", [0.576471, 0.858824, 0.439216]),
    ("Grey", [0.752941, 0.752941, 0.752941]),
    ("HuntersGreen", [0.13, 0.37, 0.31]),
    ("IndianRed", [0.309804, 0.184314, 0.184314]),
    ("Khaki", [0.623529, 0.623529, 0.372549]),
    ("LightBlue", [0.74902, 0.847059, 0.847059]),
    ("LightGray", [0.658824, 0.658824, 0.658824]),
    ("LightGrey", [0.658824, 0.658824, 0.658824]),
    ("LightSteelBlue", [0.560784, 0.560784, 0.737255]),
    ("LightWood", [0.91, 0.76, 0.65]),
    ("Light_Purple", [0.87, 0.58, 0.98]),
    ("LimeGreen", [0.196078, 0.8, 0.196078]),
    ("Magenta", [1.0, 0.0, 1.0]),
    ("MandarinOrange", [0.89, 0.47, 0.2]),
    ("Maroon", [0.556863, 0.137255, 0.419608]),
    ("Med_Purple", [0.73, 0.16, 0.96]),
    ("MediumAquamarine", [0.196078, 0.8, 0.6]),
    ("MediumBlue", [0.196078, 0.196078, 0.8]),
    ("MediumForestGreen", [0.419608, 0.556863, 0.137255]),
    ("MediumGoldenrod", [0.917647, 0.917647, 0.678431]),
    ("MediumOrchid", [0.576471, 0.439216, 0.858824]),
    ("MediumSeaGreen", [0.258824, 0.435294, 0.258824]),
    ("MediumSlateBlue", [0.498039, 0.0, 1.0]),
    ("MediumSpringGreen", [0.498039, 1.0, 0.0]),
    ("MediumTurquoise", [0.439216, 0.858824, 0.858824]),
    ("MediumVioletRed", [0.858824, 0.439216, 0.576471]),
    ("MediumWood", [0.65, 0.5, 0.39]),
    ("Mica", [0.0, 0.0, 0.0]),
    ("MidnightBlue", [0.184314, 0.184314, 0.309804]),
    ("Navy", [0.137255, 0.137255, 0.556863]),
    ("NavyBlue", [0.137255, 0.137255, 0.556863]),
    ("NeonBlue", [0.3, 0.3, 1.0]),
    ("NeonPink", [1.0, 0.43, 0.78]),
    ("NewMidnightBlue", [0.0, 0.0, 0.61]),
    ("NewTan", [0.92, 0.78, 0.62]),
    ("OldGold", [0.81, 0.71, 0.23]),
    ("Orange", [1.0, 0.5, 0.0]),
    ("OrangeRed", [1.0, 0.25, 0.0]),
    ("Orchid", [0.858824, 0.439216, 0.858824]),
    ("PaleGreen", [0.560784, 0.737255, 0.560784]),
    ("Pink", [0.737255, 0.560784, 0.560784]),
    ("Plum", [0.917647, 0.678431, 0.917647]),
    ("Quartz", [0.85, 0.85, 0.95]),
    ("Red", [1.0, 0.0, 0.0]),
    ("RichBlue", [0.35, 0.35, 0.67]),
    ("Salmon", [0.435294, 0.258824, 0.258824]),
    ("Scarlet", [0.55, 0.09, 0.09]),
    ("SeaGreen", [0.137255, 0.556863, 0.419608]),
    ("SemiSweetChoc", [0.42, 0.26, 0.15]),
    ("Sienna", [0.556863, 0.419608, 0.137255]),
    ("Silver", [0.9, 0.91, 0.98]),
    ("SkyBlue", [0.196078, 0.6, 0.8]),
    ("SlateBlue", [0.0, 0.498039, 1.0]),
    ("SpicyPink", [1.0, 0.11, 0.68]),
    ("SpringGreen", [0.0, 1.0, 0.498039]),
    ("SteelBlue", [0.137255, 0.419608, 0.556863]),
    ("SummerSky", [0.22, 0.69, 0.87]),
    ("Tan", [0.858824, 0.576471, 0.439216]),
    ("Thistle", [0.847059, 0.74902, 0.847059]),
    ("Turquoise", [0.678431, 0.917647, 0.917647]),
    ("VLightGray", [0.8, 0.8, 0.8]),
    ("VLightGrey", [0.8, 0.8, 0.8]),
    ("VeryDarkBrown", [0.35, 0.16, 0.14]),
    ("Very_Light_Purple", [0.94, 0.81, 0.99]),
    ("Violet", [0.309804, 0.184314, 0.309804]),
    ("VioletRed", [0.8, 0.196078, 0.6]),
    ("Wheat", [0.847059, 0.847059, 0.74902]),
    ("White", [1.0, 1.0, 1.0]),
    ("Yellow", [1.0, 1.0, 0.0]),
    ("YellowGreen", [0.6, 0.8, 0.196078]),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grays_and_clear_are_there() {
        let find = |name: &str| {
            let found = table().find(|(known, _)| known == name);
            match found {
                Some((_, Value::Terms(terms))) => terms.to_color(),
                other => panic!("{name}: {other:?}"),
            }
        };
        assert_eq!(find("Gray05").rgb, DVec3::splat(0.05));
        assert_eq!(find("Clear").filter, 1.0);
        assert_eq!(find("SteelBlue").rgb.z, 0.556863);
    }
}
