// Brazilian disc: cylinder of diameter D and thickness t, axis along z, loaded along y through two strips.
// Lengths in metres. Set the parameters from outside: gmsh brazilian.geo -3 -setnumber bulk 0.0098 -setnumber across 4
SetFactory("OpenCASCADE");

DefineConstant[
  D = 0.2            // diameter
  t = 0.1            // thickness
  width = 0.08       // strip width / D: the strip is the arc |x| <= width D / 2
  across = 3         // elements across a strip
  bulk = 0.0153      // element size away from the strips
  growth = 0.4       // increase of the element size per distance from the strips
  inner = 0.25       // Delaunay makes inner elements about 1/4 larger than asked: ask for that much less inside
];

R = D/2;
a = Asin(width);     // half the angle a strip spans
strip = 2*R*a/across;

// Arcs of the back face, anticlockwise: top strip, left, bottom strip, right. Nothing lies at x = 0: the crack has to
// find its way.
Circle(1) = {0, 0, -t/2, R, Pi/2 - a, Pi/2 + a};
Circle(2) = {0, 0, -t/2, R, Pi/2 + a, 3*Pi/2 - a};
Circle(3) = {0, 0, -t/2, R, 3*Pi/2 - a, 3*Pi/2 + a};
Circle(4) = {0, 0, -t/2, R, -Pi/2 + a, Pi/2 - a};
Coherence;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
body() = Extrude {0, 0, t} { Surface{1}; };

Physical Volume("disc") = {body(1)};
Physical Surface("top") = {body(2)};
Physical Surface("bottom") = {body(4)};
Physical Surface("side") = {body(3), body(5)};
Physical Surface("front") = {body(0)};
Physical Surface("back") = {1};

// `strip` on the strips, growing with the distance from them to `bulk`.
Field[1] = Distance;
Field[1].SurfacesList = {body(2), body(4)};
Field[1].Sampling = 60;
Field[2] = Distance;
Field[2].SurfacesList = {1, body(0), body(2), body(3), body(4), body(5)};
Field[2].Sampling = 60;
Field[3] = MathEval;
Field[3].F = Sprintf("min(%g, %g + %g*F1)*(1 - %g*min(1, F2/%g))", bulk, strip, growth, inner, bulk);
Background Field = 3;

Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = 6;       // frontal Delaunay on surfaces
Mesh.Algorithm3D = 1;     // Delaunay in the volume
Mesh.Optimize = 1;
Mesh.OptimizeNetgen = 1;
