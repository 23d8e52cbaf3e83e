// Quarter of a plate of 400 x 400 mm with a hole of radius 10 mm. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  h = 0.001          // element size at the hole
];

a = 0.01; L = 0.2;
r = 1.1 * a;         // the crown: a tenth of the radius thick, the last 10 degrees before the y-axis
c = Cos(80 * Pi / 180); s = Sin(80 * Pi / 180);

Point(1) = {0, 0, 0};
Point(2) = {a, 0, 0, h};
Point(3) = {a * c, a * s, 0, h};
Point(4) = {0, a, 0, h};
Point(5) = {0, r, 0, h};
Point(6) = {r * c, r * s, 0, h};
Point(7) = {L, 0, 0, 20 * h};
Point(8) = {L, L, 0, 20 * h};
Point(9) = {0, L, 0, 20 * h};
Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
Line(3) = {4, 5};
Circle(4) = {5, 1, 6};
Line(5) = {6, 3};
Line(6) = {2, 7};
Line(7) = {7, 8};
Line(8) = {8, 9};
Line(9) = {9, 5};
Curve Loop(1) = {2, 3, 4, 5};
Curve Loop(2) = {6, 7, 8, 9, 4, 5, -1};
Plane Surface(1) = {1};
Plane Surface(2) = {2};

Physical Surface("plate") = {1, 2};
Physical Surface("crown") = {1};
Physical Curve("x_axis") = {6};
Physical Curve("y_axis") = {3, 9};
Physical Curve("pulled") = {7};
Physical Point("side") = {2};
Physical Point("top") = {4};

Mesh.Algorithm = 6;
Mesh.Optimize = 1;
