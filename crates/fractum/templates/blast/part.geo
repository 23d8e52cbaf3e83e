// Rock of 4 x 3 m with a blast hole of 100 mm, 1 m below its surface, in m: gmsh part.geo -2
SetFactory("OpenCASCADE");
Rectangle(1) = {-2, -2, 0, 4, 3};
Disk(2) = {0, 0, 0, 0.05};
BooleanDifference(3) = { Surface{1}; Delete; }{ Surface{2}; Delete; };
Physical Surface("rock") = {3};
Physical Curve("hole") = Curve In BoundingBox {-0.1, -0.1, -1, 0.1, 0.1, 1};
Physical Curve("far") = {Curve In BoundingBox {-2.1, -2.1, -1, -1.9, 1.1, 1}, Curve In BoundingBox {1.9, -2.1, -1, 2.1, 1.1, 1}, Curve In BoundingBox {-2.1, -2.1, -1, 2.1, -1.9, 1}};
Mesh.Algorithm = 5;                       // Delaunay: no rows that cracks could follow
Field[1] = MathEval;
Field[1].F = "0.012 + 0.025*Sqrt(x*x + y*y)";
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0;
