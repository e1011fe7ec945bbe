// A workbench: an exact CSG part, glass, a mirror and a mesh on a checkered floor.
// Render it with:  octray render scenes/workbench/workbench.pov -o workbench.png
// The scene uses z for up; POV-Ray's own habit is y.
#version 3.7;

global_settings {
  assumed_gamma 1.0
  max_trace_level 12
}

camera {
  right -x * 16 / 9    // right-handed, as the parts were drawn
  sky z
  location <-8.6, -14.0, 8.2>
  look_at <0.2, -0.55, 0.85>
  angle 42
}

// Lights: a warm key, a cool fill from the left, a small red spot from behind.
light_source { <9, -9, 16> rgb <1.00, 0.93, 0.80> * 0.85 }
light_source { <-14, -6, 9> rgb <0.30, 0.45, 0.80> * 0.75 }
light_source {
  <-5, 11, 9> rgb <1.0, 0.35, 0.20> * 0.9
  spotlight point_at <0, 0, 0> radius 22 falloff 34
}

sky_sphere {
  pigment {
    gradient z
    color_map {
      [0.00 rgb <0.80, 0.82, 0.85>]
      [0.35 rgb <0.42, 0.54, 0.72>]
      [1.00 rgb <0.10, 0.17, 0.32>]
    }
  }
}

// Floor
plane {
  z, 0
  pigment { checker rgb <0.66, 0.64, 0.60> rgb <0.13, 0.15, 0.18> scale 1.5 translate -z * 0.3 }
  finish { ambient 0.05 diffuse 0.75 specular 0.15 roughness 0.02 reflection { 0.03, 0.25 falloff 3 } }
}

// ---------------------------------------------------------------- the part
#declare Steel = texture {
  pigment { rgb <0.52, 0.57, 0.64> }
  finish { ambient 0.04 diffuse 0.62 specular 0.6 roughness 0.03 metallic 0.5 reflection { 0.04, 0.30 falloff 3 metallic 0.5 } }
}
#declare Brass = texture {
  pigment { rgb <0.80, 0.50, 0.14> }
  finish { ambient 0.04 diffuse 0.55 specular 0.6 roughness 0.025 metallic 1 reflection { 0.16 metallic 1 } }
}

#declare Bolts = 8;
#declare Flange = difference {
  union {
    cylinder { 0, z * 0.7, 3.2 }
    cylinder { 0, z * 2.6, 1.75 }
    torus { 1.95, 0.2 rotate x * 90 translate z * 0.9 }
    // Four ribs
    #declare I = 0;
    #while (I < 4)
      intersection {
        box { <0, -0.16, 0>, <3.0, 0.16, 2.4> }
        plane { <1, 0, 1.15>, 2.35 }
        rotate z * (45 + 90 * I)
      }
      #declare I = I + 1;
    #end
  }
  // The bore ends in the faces it cuts: coincident on purpose.
  cylinder { 0, z * 2.6, 1.15 }
  cone { z * 2.2, 1.15, z * 2.6, 1.42 }
  #declare I = 0;
  #while (I < Bolts)
    union {
      cylinder { 0, z * 0.7, 0.27 }
      cylinder { z * 0.5, z * 0.7, 0.46 }
      translate x * 2.55
      rotate z * (360 / Bolts * I)
    }
    #declare I = I + 1;
  #end
  // Cross holes through the collar
  cylinder { <-3, 0, 1.75>, <3, 0, 1.75>, 0.36 }
  cylinder { <0, -3, 1.75>, <0, 3, 1.75>, 0.36 }
  texture { Steel }
}
object { Flange rotate z * 12 translate <-1.0, 0.6, 0> }

// A bearing ring with its balls, leaning on nothing: standing in front.
union {
  difference {
    cylinder { 0, z * 0.55, 1.30 }
    cylinder { 0, z * 0.55, 0.98 }
    torus { 0.88, 0.20 rotate x * 90 translate z * 0.275 }
  }
  difference {
    cylinder { 0, z * 0.55, 0.78 }
    cylinder { 0, z * 0.55, 0.45 }
    torus { 0.88, 0.20 rotate x * 90 translate z * 0.275 }
  }
  #declare I = 0;
  #while (I < 12)
    sphere { <0.88, 0, 0.275>, 0.19 rotate z * 30 * I }
    #declare I = I + 1;
  #end
  texture { Brass }
  translate <1.9, -3.6, 0>
}

// ---------------------------------------------------------------- glass and mirror
#declare Glass = material {
  texture {
    pigment { rgbf <0.97, 1.00, 0.98, 0.98> }
    finish { ambient 0 diffuse 0.02 specular 0.8 roughness 0.003 reflection { 0, 1 fresnel on } conserve_energy }
  }
  interior { ior 1.5 }
}
sphere { <-3.9, -3.2, 1.15>, 1.15 material { Glass } }

// A lens: two balls' common part, standing on edge.
intersection {
  sphere { <-1.35, 0, 0>, 1.75 }
  sphere { <1.35, 0, 0>, 1.75 }
  material { Glass }
  rotate z * 58
  translate <0.2, -4.3, 1.115>
}

sphere {
  <4.6, 3.3, 1.9>, 1.9
  pigment { rgb <0.95, 0.95, 0.97> }
  finish { ambient 0 diffuse 0.03 specular 0.7 roughness 0.004 reflection 0.88 }
}

// ---------------------------------------------------------------- the mesh
#include "knot.inc"
object {
  Knot
  texture {
    pigment { rgb <0.10, 0.42, 0.40> }
    finish { ambient 0.05 diffuse 0.7 specular 0.35 roughness 0.03 reflection { 0.02, 0.2 falloff 4 } }
  }
  scale 0.6
  rotate x * 62
  rotate z * 20
  translate <4.3, -2.3, 2.02>
}
