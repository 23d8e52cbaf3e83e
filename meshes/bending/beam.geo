// Beam of 400 x 100 x 100 mm for bending between rollers, with or without a slot notch; plane, or in space. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  h = 0.005          // element size at mid-span
  far = 0.012        // element size at the ends
  notch = 0          // depth of the notch, less than half of the beam's, h wide; 0 for none
  layers = 0         // layers of elements across the width; 0 for a plane mesh
];

L = 0.2; D = 0.1; S = 0.15; T = 0.05; w = h / 2; z = 0.03;

Point(1) = {-L, 0, 0, far};
Point(2) = {-S, 0, 0, h};
Point(3) = {-z, 0, 0, h};
If (notch > 0)
  Point(4) = {-w, 0, 0, h};
  Point(5) = {-w, notch, 0, h};
  Point(6) = {w, notch, 0, h};
  Point(7) = {w, 0, 0, h};
  bottom[] = {4, 5, 6, 7};
Else
  Point(4) = {0, 0, 0, h};
  bottom[] = {4};
EndIf
Point(8) = {z, 0, 0, h};
Point(9) = {S, 0, 0, h};
Point(10) = {L, 0, 0, far};
Point(11) = {L, D, 0, far};
Point(12) = {T, D, 0, h};
Point(13) = {0, D, 0, h};
Point(14) = {-T, D, 0, h};
Point(15) = {-L, D, 0, far};
// On the axis, above the rollers and at mid-span.
Point(16) = {-S, D/2, 0, far};
Point(17) = {0, D/2, 0, h};
Point(18) = {S, D/2, 0, far};

path[] = {1, 2, 3, bottom[], 8, 9, 10, 11, 12, 13, 14, 15};
n = #path[];
For k In {0:n-1}
  Line(k + 1) = {path[k], path[(k + 1) % n]};
EndFor
Curve Loop(1) = {1:n};
Plane Surface(1) = {1};
Point{16, 17, 18} In Surface{1};

Field[1] = Box;
Field[1].VIn = h; Field[1].VOut = far;
Field[1].XMin = -z; Field[1].XMax = z; Field[1].YMin = 0; Field[1].YMax = D; Field[1].Thickness = 0.05;
Field[2] = Distance;
Field[2].PointsList = {2, 9, 12, 14};
Field[3] = Threshold;
Field[3].InField = 2; Field[3].SizeMin = h; Field[3].SizeMax = far; Field[3].DistMin = 0.005; Field[3].DistMax = 0.03;
Field[4] = Min;
Field[4].FieldsList = {1, 3};
Background Field = 4;
Mesh.Algorithm = 5;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeExtendFromBoundary = 0;

If (layers > 0)
  body[] = Extrude {0, 0, 0.1} { Surface{1}; Layers{layers}; };
  Physical Volume("beam") = {body[1]};
  Physical Point("pin") = {13};
  // The line under the nose: the one that the extrusion drew from point 13.
  line[] = Curve In BoundingBox {-1e-6, D - 1e-6, -1e-6, 1e-6, D + 1e-6, 0.1 + 1e-6};
  Physical Curve("nose_line") = {line[]};
Else
  Physical Surface("beam") = {1};
  Physical Point("pin") = {13};
  Physical Point("axis_left") = {16};
  Physical Point("axis_mid") = {17};
  Physical Point("axis_right") = {18};
EndIf
