// assignment.pov - the assignment scene of docs/scene.md in POV-Ray 3.7 SDL.
// Render (from this directory):
//   povray assignment.pov +W600 +H600 +L../../textures -D +Oassignment-povray.png
// POV-Ray is left-handed, but the camera vectors are given explicitly, so all
// coordinates below are exactly the right-handed ones of docs/scene.md.
#version 3.7;
#ifndef (MaxDepth) #declare MaxDepth = 6; #end
#ifndef (Adc)      #declare Adc = 0;       #end   // 1/255 is POV-Ray's default
global_settings { assumed_gamma 1 max_trace_level MaxDepth adc_bailout Adc ambient_light 1 }
default { finish { ambient 0.2 diffuse 0.8 phong 0 specular 0 } }

camera { perspective location 0 direction <0,0,-40> right <20,0,0> up <0,20,0> }
background { srgb <0.62, 0.76, 0.92> }

light_source { <  30, 40, -10> rgb 0.45 }
light_source { < -55, 30, -45> rgb 0.75 }

#macro Matte(C)   texture { pigment { srgb C } finish { ambient 0.2 diffuse 0.8 } } #end
#macro Shiny(C,S) texture { pigment { srgb C } finish { ambient 0.2 diffuse 0.8 phong 1 phong_size S } } #end

// floor
polygon { 5, <-50,-15,-40>, <50,-15,-40>, <50,-15,-200>, <-50,-15,-200>, <-50,-15,-40>
  texture { pigment { checker srgb <0.95,0.92,0.84> srgb <0.36,0.60,0.60> scale 5 translate 2.5 } } }

// back wall
polygon { 5, <-50,-15,-200>, <50,-15,-200>, <50,51.67,-200>, <-50,51.67,-200>, <-50,-15,-200>
  texture { pigment { image_map { png "cat.png" map_type 0 interpolate 2 } scale <100,66.67,1> translate <-50,-15,0> } finish { ambient 0.2 diffuse 0.65 } } }

// mirror sphere
sphere { <-13,-7,-115>, 8
  texture { pigment { srgb <0.25,0.25,0.30> } finish { ambient 0.2 diffuse 0.8 phong 1 phong_size 80 reflection { 0.8 } } } }

// glass sphere
sphere { <3.5,-11,-71>, 4
  texture { pigment { rgbt <1,1,1,0.85> } finish { ambient 0 diffuse 0 phong 1 phong_size 100 reflection { 0.1 } } }
  interior_texture { pigment { rgbt <1,1,1,0.85> } finish { ambient 0 diffuse 0 } }
  interior { ior 1.5 } }

// flower sphere
#declare FC = <3,-9,-125>; #declare FR = 6;
sphere { FC, FR
  texture { pigment { image_map { png "flower.png" map_type 0 interpolate 2 } scale 2*FR translate FC-FR }
            finish { ambient 0.2 diffuse 0.8 phong 0.5 phong_size 40 } } }

// hollow sphere
sphere { <-7,-11,-80>, 4
  texture { pigment { srgbf <1,0.86,0.92,0.95> } finish { ambient 0.2 diffuse 0.8 phong 1 phong_size 60 } }
  interior_texture { pigment { srgbf <1,0.86,0.92,0.95> } finish { ambient 0 diffuse 0 } }
  hollow }

// three small spheres
sphere { <-12.5,-13,-77>, 2 Shiny(<0.95,0.75,0.15>, 40) }
sphere { <12.5,-13,-80>, 2  Shiny(<0.20,0.45,0.90>, 40) }
sphere { <-1.6,-13.5,-66>, 1.5 Shiny(<0.85,0.18,0.15>, 40) }

// plaid
#declare M3 = function(v) { select(0.5-abs(mod(floor(v)+3000,3)),0,1) }   // 1 when floor(v) mod 3 == 0
#declare Plaid = texture { pigment { function { 0.1 + 0.4*(M3(x+y-5)+M3(x-y-5)) }
    color_map { [0.3 srgb <1,0.5,0.8>][0.3 srgb <0.95,0.35,0.7>][0.7 srgb <0.95,0.35,0.7>][0.7 srgb <0.9,0.2,0.6>] } }
  finish { ambient 0.2 diffuse 0.8 phong 0.5 phong_size 30 } }
#declare CX = 17; #declare CZ = -118;
cylinder { <CX,-15,CZ>, <CX,-5,CZ>, 5 open texture { Plaid } }
cone { <CX,-5,CZ>, 6.5, <CX,3,CZ>, 0 texture { Plaid } }

// tetrahedron, edge 8
#declare TE = 8; #declare TR = TE/sqrt(3); #declare TP = radians(-10);
#declare T0 = <CX+TR*sin(TP),               3, CZ+TR*cos(TP)>;
#declare T1 = <CX+TR*sin(TP+radians(120)),  3, CZ+TR*cos(TP+radians(120))>;
#declare T2 = <CX+TR*sin(TP+radians(240)),  3, CZ+TR*cos(TP+radians(240))>;
#declare T3 = <CX, 3+TE*sqrt(2/3), CZ>;
mesh { triangle {T0,T1,T2} triangle {T0,T1,T3} triangle {T1,T2,T3} triangle {T2,T0,T3} Shiny(<0.25,0.70,0.35>, 30) }
