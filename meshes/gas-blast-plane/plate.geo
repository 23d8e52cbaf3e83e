// Plate of 160 x 160 mm with a hole of radius 5 mm in its middle. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  h = 0.0012,        // element size at the hole
  far = 0.0022       // and at the edge of the plate
];

a = 0.005; L = 0.08;

Point(1) = {0, 0, 0};
Point(2) = {a, 0, 0, h};
Point(3) = {0, a, 0, h};
Point(4) = {-a, 0, 0, h};
Point(5) = {0, -a, 0, h};
Point(6) = {-L, -L, 0, far};
Point(7) = {L, -L, 0, far};
Point(8) = {L, L, 0, far};
Point(9) = {-L, L, 0, far};
Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
Circle(3) = {4, 1, 5};
Circle(4) = {5, 1, 2};
Line(5) = {6, 7};
Line(6) = {7, 8};
Line(7) = {8, 9};
Line(8) = {9, 6};
Curve Loop(1) = {5, 6, 7, 8};
Curve Loop(2) = {1, 2, 3, 4};
Plane Surface(1) = {1, 2};

Physical Surface("plate") = {1};
Physical Curve("hole") = {1, 2, 3, 4};
Physical Curve("edge") = {5, 6, 7, 8};

Mesh.Algorithm = 5;
Mesh.Optimize = 1;
