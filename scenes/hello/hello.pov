// The first scene: an exact ball on a floor.
#version 3.7;
global_settings { assumed_gamma 1.0 }
camera { location <3, 2.2, -5> look_at <0, 0.9, 0> angle 40 }
light_source { <6, 9, -5> rgb 0.9 }
background { rgb <0.55, 0.68, 0.85> }
plane { y, 0 pigment { checker rgb 0.85 rgb <0.25, 0.35, 0.5> } }
sphere {
  y, 1
  pigment { rgb <0.9, 0.25, 0.15> }
  finish { specular 0.6 roughness 0.02 reflection { 0.05, 0.4 falloff 3 } }
}
