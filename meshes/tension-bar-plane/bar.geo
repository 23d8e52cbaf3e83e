// Plane bar L x H along x, centred on the origin. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  L = 0.1            // length
  H = 0.02           // depth
  h = 0.004          // element size
  algorithm = 5      // 5: Delaunay; 6: frontal, rows of nearly equilateral triangles; 0: squares cut by alternating diagonals
];

Point(1) = {-L/2, -H/2, 0, h};
Point(2) = {L/2, -H/2, 0, h};
Point(3) = {L/2, H/2, 0, h};
Point(4) = {-L/2, H/2, 0, h};
For k In {1:3}
  Line(k) = {k, k + 1};
EndFor
Line(4) = {4, 1};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};

Physical Surface("bar") = {1};
Physical Curve("left") = {4};
Physical Curve("right") = {2};

If (algorithm == 0)
  Transfinite Curve{1, 3} = Round(L/h) + 1;
  Transfinite Curve{2, 4} = Round(H/h) + 1;
  Transfinite Surface{1} Alternate;
Else
  Mesh.Algorithm = algorithm;
EndIf
Mesh.Optimize = 1;
