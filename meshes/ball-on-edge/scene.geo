// A ball above an edge, and a slab beside it. Lengths in metres.
SetFactory("OpenCASCADE");

DefineConstant[
  R = 0.06           // radius of the ball
  drop = 0.151       // height of its centre
  size = 0.012       // elements of the ball
  coarse = 0.03      // elements of the slab
];

Sphere(1) = {0, 0, drop, R};
Box(2) = {0.06, -0.12, 0, 0.2, 0.24, 0.03};
Physical Volume("ball") = {1};
Physical Volume("slab") = {2};
Physical Surface("slab-bottom") = Surface In BoundingBox {0.05, -0.13, -1e-4, 0.27, 0.13, 1e-4};
MeshSize { PointsOf { Volume{1}; } } = size;
MeshSize { PointsOf { Volume{2}; } } = coarse;

Mesh.Algorithm = 6;
Mesh.Algorithm3D = 1;
Mesh.Optimize = 1;
Mesh.OptimizeNetgen = 1;
