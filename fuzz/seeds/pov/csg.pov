#version 3.7;
global_settings { assumed_gamma 1.0 max_trace_level 5 }
#declare Radius = 1.5;
#declare Steel = texture { pigment { color rgb <0.6, 0.6, 0.7> } finish { ambient 0.1 diffuse 0.6 phong 0.5 reflection 0.2 } };
camera { location <0, 3, -8> look_at <0, 0, 0> angle 40 }
light_source { <10, 20, -10> color rgb 1 }
light_source { <-10, 5, -5> rgb <0.2, 0.3, 0.4> spotlight point_at 0 radius 20 falloff 30 shadowless }
background { color rgb <0.2, 0.3, 0.5> }
plane { y, -Radius pigment { checker rgb 1, rgb 0.2 scale 0.5 } }
difference {
  intersection { sphere { 0, Radius } box { -1.2, 1.2 } }
  union { cylinder { -2*x, 2*x, 0.5 } cylinder { -2*z, 2*z, 0.5 } cone { -2*y, 0.3, 2*y, 0.6 } }
  texture { Steel } rotate <10, 20, 30> translate <0, sin(0.5), 0>
}
torus { 2, 0.25 pigment { gradient y color_map { [0 rgb 0] [1 rgb x] } } scale <1, 2, 1> clipped_by { plane { z, 0 } } }
#local I = 0;
#while (I < 3)
  sphere { <I, 2, 0>, 0.2 pigment { rgbf <1, 1, 1, 0.9> } interior { ior 1.5 } }
  #local I = I + 1;
#end
#macro Tri(A) triangle { A, A + x, A + y } #end
Tri(<0, 0, 1>)
mesh2 { vertex_vectors { 3, <0,0,0>, <1,0,0>, <0,1,0> } face_indices { 1, <0,1,2> } }
