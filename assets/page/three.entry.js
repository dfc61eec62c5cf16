export { AmbientLight, BufferAttribute, BufferGeometry, Color, DoubleSide, FrontSide, LineBasicMaterial, LineSegments, Mesh, PerspectiveCamera, Raycaster, Scene, ShaderMaterial, SphereGeometry, MeshBasicMaterial, Vector2, Vector3, WebGLRenderer, Box3 } from 'three';
export { OrbitControls } from 'three/addons/controls/OrbitControls.js';
