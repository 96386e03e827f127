// view.js - two meshes side by side under one camera: turned by mouse, touch or keys, opened by a cut.
import {
    BackSide,
    BufferAttribute,
    BufferGeometry,
    Color,
    DirectionalLight,
    FrontSide,
    Group,
    HemisphereLight,
    LineBasicMaterial,
    LineSegments,
    Mesh,
    MeshStandardMaterial,
    PerspectiveCamera,
    Plane,
    Scene,
    Vector3,
    WebGLRenderer,
    WireframeGeometry,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

// Edges of more triangles than these hide the surface and fill the memory.
const MOST_EDGES = 400000;

export class View {
    constructor(canvas) {
        this.canvas = canvas;
        this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
        this.renderer.setScissorTest(true);
        this.camera = new PerspectiveCamera(35, 1, 0.01, 100);
        this.camera.up.set(0, 0, 1);
        this.camera.position.set(2, -2.6, 1.5);
        this.controls = new OrbitControls(this.camera, canvas);
        this.controls.addEventListener('change', () => this.draw());
        this.plane = new Plane(new Vector3(-1, 0, 0), 1e9);
        this.sides = [0, 1].map(() => this.makeScene());
        canvas.addEventListener('keydown', event => this.key(event));
        new ResizeObserver(() => this.draw()).observe(canvas);
        matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.draw());
    }

    makeScene() {
        const scene = new Scene();
        const light = new DirectionalLight(0xffffff, 2);
        const holder = new Group();
        light.position.set(1, -1.5, 2);
        scene.add(new HemisphereLight(0xffffff, 0x777788, 1.6), light, holder);
        return { scene, holder };
    }

    /** The frame that both sides share: the box of the mesh before. */
    frame({ low, high }) {
        this.centre = new Vector3(...low).add(new Vector3(...high)).multiplyScalar(0.5);
        this.size = Math.max(...high.map((x, i) => x - low[i])) || 1;
        this.low = low;
        this.high = high;
    }

    show(side, mesh) {
        const { holder } = this.sides[side];
        holder.traverse(part => {
            part.geometry?.dispose();
            part.material?.dispose();
        });
        holder.clear();
        this.sides[side].mesh = mesh;
        if (mesh) {
            const geometry = new BufferGeometry();
            geometry.setAttribute('position', new BufferAttribute(mesh.positions, 3));
            geometry.setIndex(new BufferAttribute(mesh.triangles, 1));
            const clippingPlanes = [this.plane];
            const paint = (color, face) =>
                new Mesh(
                    geometry,
                    new MeshStandardMaterial({
                        color,
                        side: face,
                        flatShading: true,
                        roughness: 0.8,
                        clippingPlanes,
                    }),
                );
            holder.add(paint(0xc8c4bc, FrontSide), paint(0xb8604c, BackSide));
            if (this.wire && mesh.triangles.length / 3 <= MOST_EDGES)
                holder.add(
                    new LineSegments(
                        new WireframeGeometry(geometry),
                        new LineBasicMaterial({
                            color: 0x1f3f66,
                            transparent: true,
                            opacity: 0.5,
                            clippingPlanes,
                        }),
                    ),
                );
            const scale = 1.4 / this.size;
            holder.scale.setScalar(scale);
            holder.position.copy(this.centre).multiplyScalar(-scale);
        }
        this.draw();
    }

    edges(on) {
        this.wire = on;
        for (const side of [0, 1]) this.show(side, this.sides[side].mesh);
    }

    /** What lies beyond a share of the box along an axis is taken away; 0 takes nothing. */
    cut(share, axis) {
        this.renderer.localClippingEnabled = share > 0;
        if (!this.centre) return;
        const normal = [0, 0, 0];
        normal[axis] = -1;
        const place = this.high[axis] - share * (this.high[axis] - this.low[axis]);
        this.plane.set(new Vector3(...normal), ((place - this.centre.getComponent(axis)) * 1.4) / this.size);
        this.draw();
    }

    key(event) {
        const turn = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[
            event.key
        ];
        const offset = this.camera.position;
        if (turn) {
            offset.applyAxisAngle(this.camera.up, turn[0]);
            const side = new Vector3().crossVectors(this.camera.up, offset).normalize();
            const steep = offset.angleTo(this.camera.up) + turn[1];
            if (steep > 0.05 && steep < 3.09) offset.applyAxisAngle(side, turn[1]);
        } else if (event.key === '+' || event.key === '=') offset.multiplyScalar(0.9);
        else if (event.key === '-') offset.multiplyScalar(1 / 0.9);
        else return;
        event.preventDefault();
        this.controls.update();
        this.draw();
    }

    /** Drawn when something has changed, once a frame. */
    draw() {
        this.waiting ??= requestAnimationFrame(() => {
            this.waiting = undefined;
            const { clientWidth: width, clientHeight: height } = this.canvas;
            if (width === 0 || height === 0) return;
            this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
            this.renderer.setSize(width, height, false);
            this.renderer.setClearColor(new Color(getComputedStyle(document.body).backgroundColor), 1);
            this.camera.aspect = width / 2 / height;
            this.camera.updateProjectionMatrix();
            this.sides.forEach(({ scene }, i) => {
                this.renderer.setViewport((i * width) / 2, 0, width / 2, height);
                this.renderer.setScissor((i * width) / 2, 0, width / 2, height);
                this.renderer.render(scene, this.camera);
            });
        });
    }
}
