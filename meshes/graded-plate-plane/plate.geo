// Plate of 1 x 0.5 m with a slot notch of 0.1 m in the middle of its lower edge, fine around the tip of the notch alone. Lengths in metres.
SetFactory("OpenCASCADE");

DefineConstant[
  h = 0.0025         // element size at the tip
  far = 0.02         // element size elsewhere
  radius = 0.022     // of the fine disc, and the width of the ring in which elements grow
];

L = 1; H = 0.5; notch = 0.1; width = 0.004;

Rectangle(1) = {0, 0, 0, L, H};
Rectangle(2) = {L/2 - width/2, -1e-3, 0, width, notch + 1e-3};
BooleanDifference(3) = { Surface{1}; Delete; }{ Surface{2}; Delete; };
e = 1e-6;
left() = Curve In BoundingBox {-e, -e, -e, e, H + e, e};
right() = Curve In BoundingBox {L - e, -e, -e, L + e, H + e, e};

Physical Surface("plate") = {3};
Physical Curve("left") = {left()};
Physical Curve("right") = {right()};

Field[1] = Ball;
Field[1].VIn = h; Field[1].VOut = far;
Field[1].XCenter = L/2; Field[1].YCenter = notch + 0.6*radius; Field[1].Radius = radius; Field[1].Thickness = radius;
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = 5;
Mesh.Optimize = 1;
