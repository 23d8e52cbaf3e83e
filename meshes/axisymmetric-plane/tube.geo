// Section of a tube about the y axis: radii A and B, height H, centred on y = 0. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  A = 0.05           // inner radius; 0 makes a rod
  B = 0.1            // outer radius
  H = 0.05           // height
  h = 0.004          // element size
  algorithm = 5      // 5: Delaunay; 6: frontal, rows of nearly equilateral triangles; 0: squares cut by alternating diagonals
];

Point(1) = {A, -H/2, 0, h};
Point(2) = {B, -H/2, 0, h};
Point(3) = {B, H/2, 0, h};
Point(4) = {A, H/2, 0, h};
For k In {1:3}
  Line(k) = {k, k + 1};
EndFor
Line(4) = {4, 1};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};

Physical Surface("tube") = {1};
Physical Curve("bottom") = {1};
Physical Curve("outer") = {2};
Physical Curve("top") = {3};
Physical Curve("inner") = {4};

If (algorithm == 0)
  Transfinite Curve{1, 3} = Round((B - A)/h) + 1;
  Transfinite Curve{2, 4} = Round(H/h) + 1;
  Transfinite Surface{1} Alternate;
Else
  Mesh.Algorithm = algorithm;
EndIf
Mesh.Optimize = 1;
