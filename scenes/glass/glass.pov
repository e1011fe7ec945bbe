// A glass of water with ice and bubbles, on a round table.
// Everything that touches shares its faces exactly: the water fills the glass to the wall, the ice
// floats half out of the water, the bubbles are balls of air in it. Where solids overlap the smaller
// one is there, so the ice need not be cut out of the water.
// Render it with:  octray render scenes/glass/glass.pov -o glass.png
// The scene uses z for up; POV-Ray's own habit is y.
#version 3.7;

global_settings {
  assumed_gamma 1.0
  max_trace_level 12
  adc_bailout 0.01
}

camera {
  right -x * 16 / 9
  sky z
  location <1.9, -15.5, 5.6>
  look_at <0.85, 0, 2.62>
  angle 37
}

// A window on the left, a lamp behind on the right, a little from above.
light_source { <-11, -6, 13> rgb <1.00, 0.95, 0.86> * 0.85 }
light_source { <9, 12, 8> rgb <0.55, 0.70, 1.00> * 0.55 }
light_source { <2, -14, 18> rgb 0.2 }

sky_sphere {
  pigment {
    gradient z
    color_map {
      [0.00 rgb <0.10, 0.09, 0.10>]
      [0.36 rgb <0.26, 0.25, 0.28>]
      [0.47 rgb <0.62, 0.66, 0.72>]
      [0.52 rgb <0.92, 0.88, 0.82>]
      [0.60 rgb <0.55, 0.68, 0.84>]
      [1.00 rgb <0.12, 0.22, 0.42>]
    }
  }
}

// ---------------------------------------------------------------- the table
cylinder {
  -z * 0.4, 0, 7.4
  pigment {
    gradient x
    color_map {
      [0.0 rgb <0.12, 0.22, 0.38>]
      [0.5 rgb <0.12, 0.22, 0.38>]
      [0.5 rgb <0.88, 0.83, 0.74>]
      [1.0 rgb <0.88, 0.83, 0.74>]
    }
    scale 2.6
    rotate z * 24
    translate x * 0.5
  }
  finish { ambient 0.05 diffuse 0.75 specular 0.1 roughness 0.05 reflection { 0.02, 0.15 falloff 4 } }
}

// ---------------------------------------------------------------- materials
#declare Clear = finish {
  ambient 0 diffuse 0 specular 0.7 roughness 0.002
  reflection { 0, 1 fresnel on } conserve_energy
}
#declare Glass = material {
  texture { pigment { rgbt 1 } finish { Clear } }
  interior { ior 1.5 fade_distance 14 fade_power 1001 fade_color <0.25, 0.75, 0.55> }
}
#declare Water = material {
  texture { pigment { rgbt 1 } finish { Clear } }
  interior { ior 1.333 fade_distance 6 fade_power 1001 fade_color <0.15, 0.60, 0.90> }
}
#declare Ice = material {
  texture { pigment { rgbt <0.97, 0.99, 1.0, 0.985> } finish { Clear diffuse 0.3 } }
  interior { ior 1.31 }
}
#declare Air = material {
  texture { pigment { rgbt 1 } finish { Clear } }
  interior { ior 1.0 }
}

// ---------------------------------------------------------------- the glass and the water
// Inside it is a cone from radius Narrow at height Foot to Wide at Rim; the water is the same cone
// up to Level.
#declare Foot = 0.5;
#declare Rim = 4.6;
#declare Level = 3.3;
#declare Narrow = 1.23;
#declare Wide = 1.75;
#declare Wall = 0.14;

difference {
  cone { 0, Narrow + 0.02, z * Rim, Wide + Wall }
  cone { z * Foot, Narrow, z * Rim, Wide }
  material { Glass }
}
cone {
  z * Foot, Narrow
  z * Level, Narrow + (Wide - Narrow) * (Level - Foot) / (Rim - Foot)
  material { Water }
}

// ---------------------------------------------------------------- ice: cubes with worn corners
#declare Cube = intersection {
  box { -0.62, 0.62 }
  sphere { 0, 0.93 }
}
object { Cube rotate <24, 18, 31> translate <-0.52, -0.28, Level - 0.28> material { Ice } }
object { Cube scale 0.92 rotate <-15, 37, -12> translate <0.68, 0.42, Level - 0.22> material { Ice } }

// Air that froze in, and air that rises.
sphere { <-0.55, -0.25, Level - 0.30>, 0.17 material { Air } }
sphere { <0.74, 0.40, Level - 0.20>, 0.11 material { Air } }
sphere { <0.25, -0.55, 1.55>, 0.22 material { Air } }
sphere { <-0.45, 0.10, 1.05>, 0.14 material { Air } }
sphere { <0.55, -0.30, 2.25>, 0.10 material { Air } }
sphere { <-0.62, -0.50, 1.90>, 0.07 material { Air } }
// Half a bubble, stuck to the bottom.
sphere { <0.35, 0.25, Foot>, 0.20 material { Air } }

// ---------------------------------------------------------------- a straw, hollow, leaning on the rim
difference {
  cylinder { -z * 0.1, z * 6.6, 0.15 }
  cylinder { -z * 0.1, z * 6.6, 0.115 }
  plane { z, 0 }
  pigment { rgb <0.10, 0.45, 0.42> }
  finish { ambient 0.06 diffuse 0.75 specular 0.4 roughness 0.02 }
  rotate y * 24.5
  translate <-0.72, 0.55, 0.62>
}

// A lemon beside it, and a steel ball that mirrors the whole.
sphere {
  0, 1
  scale <1.05, 0.80, 0.80>
  rotate z * 35
  translate <3.5, -0.4, 0.80>
  pigment { rgb <0.93, 0.70, 0.08> }
  finish { ambient 0.06 diffuse 0.75 specular 0.3 roughness 0.05 }
}
sphere {
  <-3.4, 1.9, 1.1>, 1.1
  pigment { rgb <0.95, 0.95, 0.97> }
  finish { ambient 0 diffuse 0.04 specular 0.7 roughness 0.004 reflection 0.85 }
}
