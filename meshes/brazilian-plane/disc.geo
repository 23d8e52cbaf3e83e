// Plane Brazilian disc of diameter D in the xy-plane, loaded along y through two strips.
// Lengths in metres. Set the parameters from outside: gmsh disc.geo -2 -setnumber bulk 0.004 -setnumber across 6
SetFactory("OpenCASCADE");

DefineConstant[
  D = 0.2            // diameter
  width = 0.08       // strip width / D: the strip is the arc |x| <= width D / 2
  across = 6         // elements across a strip
  bulk = 0.004       // element size away from the strips
  growth = 0.2       // increase of the element size per distance from the strips
];

R = D/2;
a = Asin(width);     // half the angle a strip spans
strip = 2*R*a/across;

// Arcs anticlockwise: top strip, left, bottom strip, right. Nothing lies at x = 0: the crack has to find its way.
Circle(1) = {0, 0, 0, R, Pi/2 - a, Pi/2 + a};
Circle(2) = {0, 0, 0, R, Pi/2 + a, 3*Pi/2 - a};
Circle(3) = {0, 0, 0, R, 3*Pi/2 - a, 3*Pi/2 + a};
Circle(4) = {0, 0, 0, R, -Pi/2 + a, Pi/2 - a};
Coherence;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};

Physical Surface("disc") = {1};
Physical Curve("top") = {1};
Physical Curve("bottom") = {3};
Physical Curve("side") = {2, 4};
// One end of the bottom strip, for static runs: held along x it keeps the disc from drifting sideways.
pin() = PointsOf{ Curve{3}; };
Physical Point("pin") = {pin(0)};

// `strip` on the strips, growing with the distance from them to `bulk`.
Field[1] = Distance;
Field[1].CurvesList = {1, 3};
Field[1].Sampling = 60;
Field[2] = MathEval;
Field[2].F = Sprintf("min(%g, %g + %g*F1)", bulk, strip, growth);
Background Field = 2;

Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = 5;       // Delaunay: less regular than the frontal one, no rows of elements to follow
Mesh.Optimize = 1;
