// Quarter of a plate of 1.6 x 1.6 m with a crack of half length a = 20 mm along x in its middle, whose upper face is
// the group "crack". Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  elements = 10,     // along half of the crack
  grade = 40         // size at the edge of the plate over that at the crack
];

a = 0.02; L = 0.8;
h = a / elements;

Point(1) = {0, 0, 0, h};
Point(2) = {a, 0, 0, h};
Point(3) = {L, 0, 0, grade * h};
Point(4) = {L, L, 0, grade * h};
Point(5) = {0, L, 0, grade * h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 1};
Transfinite Curve {1} = elements + 1;
Curve Loop(1) = {1, 2, 3, 4, 5};
Plane Surface(1) = {1};

Physical Surface("plate") = {1};
Physical Curve("crack") = {1};
Physical Curve("ahead") = {2};
Physical Curve("x_axis") = {5};
Physical Point("middle") = {1};

Mesh.Algorithm = 5;
Mesh.Optimize = 1;
