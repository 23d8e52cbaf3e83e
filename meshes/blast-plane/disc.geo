// Disc with a hole in its middle. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  R = 0.072,         // radius of the disc
  a = 0.003225,      // radius of the hole
  h = 0.0005,        // element size at the hole
  far = 0.0009,      // at the rim
  length = 0         // of a cylinder; 0 for the plane disc
];

Point(1) = {0, 0, 0};
Point(2) = {a, 0, 0, h};
Point(3) = {0, a, 0, h};
Point(4) = {-a, 0, 0, h};
Point(5) = {0, -a, 0, h};
Point(6) = {R, 0, 0, far};
Point(7) = {0, R, 0, far};
Point(8) = {-R, 0, 0, far};
Point(9) = {0, -R, 0, far};
Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
Circle(3) = {4, 1, 5};
Circle(4) = {5, 1, 2};
Circle(5) = {6, 1, 7};
Circle(6) = {7, 1, 8};
Circle(7) = {8, 1, 9};
Circle(8) = {9, 1, 6};
Curve Loop(1) = {5, 6, 7, 8};
Curve Loop(2) = {1, 2, 3, 4};
Plane Surface(1) = {1, 2};

If (length == 0)
  Physical Surface("rock") = {1};
  Physical Curve("hole") = {1, 2, 3, 4};
  Physical Curve("rim") = {5, 6, 7, 8};
Else
  out[] = Extrude {0, 0, length} { Surface{1}; };
  Physical Volume("rock") = {out[1]};
  Physical Surface("ends") = {1, out[0]};
  Physical Surface("rim") = {out[2], out[3], out[4], out[5]};
  Physical Surface("hole") = {out[6], out[7], out[8], out[9]};
  Mesh.Optimize = 1;
  Mesh.OptimizeNetgen = 1;
EndIf

Mesh.Algorithm = 6;
