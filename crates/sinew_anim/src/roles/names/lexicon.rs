//! Words in joint names, and their meanings.

use super::super::role::Side;

/// Meaning of one word of a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Word {
    /// Not a body part: prefixes and suffixes of exporters.
    Noise,
    Side(Side),
    /// The part nearer to the trunk, or higher in it.
    Upper,
    Lower,
    /// The part between upper and lower: another part of the spine; in a limb, a part that humans lack.
    Mid,
    /// Before "arm" the lower part; before "leg" a part of a quadruped.
    Fore,
    /// Front of a quadruped; `Back` is its hind part.
    Front,
    Back,
    Paw,
    Wing,
    Arm,
    Leg,
    /// Leg or foot, which Japanese names do not distinguish.
    LegOrFoot,
    Body,
    /// Hips, chest or head of a CAT rig, by its place.
    Hub,
    Hip,
    Pelvis,
    Spine,
    Neck,
    Head,
    Shoulder,
    Clavicle,
    UpperArm,
    LowerArm,
    Hand,
    Wrist,
    UpperLeg,
    LowerLeg,
    Foot,
    Ankle,
    Toes,
    Tail,
    /// Twist helper beside a limb; in the neck, an ordinary bone.
    Twist,
    /// Animator's control, not a body part: an appendix if it has little skin.
    Control,
    /// Word that makes the joint an appendix, with any other words in the name.
    Appendix,
}

use Word::*;

const LEFT: Word = Word::Side(super::super::role::Side::Left);
const RIGHT: Word = Word::Side(super::super::role::Side::Right);

/// Words by meaning, in lower case. Words of up to two letters only count alone.
const WORDS: &[(Word, &str)] = &[
    // Exporters' prefixes and suffixes.
    (
        Noise,
        "mixamorig def org mch bip biped valve valvebiped cc base skeleton joint jnt jt bone bn b c d j m x",
    ),
    (Noise, "armature character char rig bind skin deform geo sk bend stretch adjust ex node object obj"),
    (LEFT, "l left lft links hidari zuo 左 ひだり"),
    (
        LEFT,
        "izquierda izquierdo izq izda gauche sinistra sinistro sx esquerda esquerdo esq linke linker linkes",
    ),
    (LEFT, "lewy lewa lewe lewej vlevo levy leva vanster vänster venstre vasen levaya levoe levyi trai kiri"),
    (LEFT, "왼쪽 왼 левая левый левое лев л"),
    (RIGHT, "r right rgt rt rechts migi you 右 みぎ"),
    (RIGHT, "derecha derecho der dcha droite droit destra destro dx direita direito rechte rechter rechtes"),
    (
        RIGHT,
        "prawy prawa prawe prawej sağ pravy prava hoger höger hojre højre hoyre oikea pravaya pravoe pravyi phai kanan",
    ),
    (RIGHT, "오른쪽 오른 правая правый правое прав п"),
    (Upper, "upper up shang 上"),
    (Lower, "lower low lo xia 下"),
    (Mid, "mid zhong 中"),
    (Fore, "fore"),
    (Front, "front vorder vorn qian"),
    (Back, "back hind rear hinter hou"),
    (Paw, "paw hoof pfote huf flipper"),
    (Wing, "wing wings feather feathers aile ala ali ailes fluegel flügel asa tsubasa 翼"),
    (Arm, "ramie ramię paze paže ruka lengan"),
    (Leg, "noga bacak jalka noha kaki"),
    (Arm, "arm ude bi gebo brazo bras braccio braco 腕 うで 臂 手臂 胳膊 팔 рука"),
    (Leg, "leg tui bein pierna jambe gamba perna 腿 脚部 다리 нога"),
    (LegOrFoot, "ashi 足 脚 あし"),
    (Body, "body 半身 hanshin"),
    (Hub, "hub"),
    (
        Pelvis,
        "pelvis becken kahanshin kanpan gupen tunbu koshibone bassin bacino pelve 골반 таз 骨盆 骨盤 臀 臀部",
    ),
    (Pelvis, "miednica kalca kalça panev bekken bäcken baekken bækken lantio tazobedrennyi pinggul"),
    (Hip, "biodro biodra heup hofte höft lonkka"),
    (Hip, "hips hip huefte hüfte kuan kuabu cadera hanche anca quadril 髋 尻 엉덩이"),
    (
        Spine,
        "dos buste ventre abdomen tronc colone vertebre vertebra echine thorax espalda espina torso cintura",
    ),
    (
        Spine,
        "dorso schiena busto coluna tronco abdome rygg rugg ruggegraat borst buik kregoslup kręgosłup tulow klatka",
    ),
    (Spine, "omurga gogus göğüs govde gövde pozvonochnik grud zhivot torso hrudnik hrud pater páteř selka"),
    (Spine, "spine chest torso abdomen waist thorax ribcage ribs stomach belly sternum lumbar trunk ab abs"),
    (Spine, "sebone koshi mune jouhanshin joohanshin hara yao xiong xiongbu jizhu jizhui fubu yaobu"),
    (Spine, "bauch brust wirbel wirbelsaeule ruecken 脊椎 脊柱 腰 胸 胸部 腹 背骨 躯干"),
    (
        Spine,
        "columna pecho torse colonne poitrine colonna petto coluna peito 척추 가슴 허리 позвоночник грудь",
    ),
    (Neck, "nek nacke hals szyja boyun krk kaula sheya leher"),
    (Neck, "neck kubi jing jingbu bozi hals cuello cou collo pescoco 목 шея 首 颈 頸 脖子 脖"),
    (Head, "tête crâne crane glowa głowa baş hoofd huvud hoved hode pää golova hlava kepala cabeça"),
    (Head, "head skull atama tou toubu kopf cabeza tete testa cabeca 머리 голова 頭 头 头部 あたま"),
    (
        Shoulder,
        "shoulder shldr shoulders kata jian jianbang schulter hombro epaule spalla ombro 어깨 肩 肩膀 かた",
    ),
    (Shoulder, "épaule omuz schouder skulder olkapaa plecho rameno bahu"),
    (Clavicle, "obojczyk kopruck sleutelbeen nyckelben solisluu klyuchica"),
    (
        Clavicle,
        "clavicle clav collar collarbone scapula sakotsu suogu schluesselbein schulterblatt 锁骨 鎖骨",
    ),
    (Clavicle, "clavicula clavicule clavicola 쇄골 ключица"),
    (
        UpperArm,
        "uarm humerus bicep biceps oberarm jouwan dabi shangbi nikoude 위팔 상완 плечо 上臂 大臂 上腕 二の腕",
    ),
    (UpperArm, "bovenarm överarm overarm olkavarsi bicipite nadloktie"),
    (
        LowerArm,
        "onderarm underarm kyynarvarsi przedramie przedramię predplechye predlokti loket lokiec łokieć dirsek elleboog armbage",
    ),
    (LowerArm, "forearm elbow farm unterarm hiji zenwan xiaobi qianbi 前腕 前臂 小臂 ひじ 肘"),
    (LowerArm, "antebrazo avantbras avambraccio antebraco codo coude gomito 아래팔 전완 팔꿈치 предплечье"),
    (Hand, "mão mao dlon dłoń hånd haand kasi käsi kist tangan paume pugno"),
    (Hand, "hand palm fist hnd tenohira shou shouzhang mano 손 кисть 手 て 手掌"),
    (Wrist, "poignet muñeca muneca polso pulso nadgarstek bilek pols handled zapyastye"),
    (Wrist, "wrist tekubi shouwan handgelenk 手首 手腕"),
    (
        UpperLeg,
        "thigh femur oberschenkel momo futomomo datui muslo cuisse coscia coxa 허벅지 бедро 大腿 太もも 太腿 もも",
    ),
    (UpperLeg, "bovenbeen udo uyluk lår laar reisi bedro stehno coxa dij paha"),
    (
        LowerLeg,
        "onderbeen underben lydka łydka baldir golen lytko saari sääri scheenbeen tibie kolano diz knæ kna knä polvi koleno",
    ),
    (
        LowerLeg,
        "calf shin shank knee tibia crus unterschenkel wade knie hiza sune xiaotui xigai 小腿 ひざ 膝 脛 膝盖",
    ),
    (LowerLeg, "pantorrilla mollet polpaccio panturrilha rodilla genou ginocchio 종아리 무릎 голень колено"),
    (Foot, "voet fot stopa ayak jalkatera chodidlo stupnya telapak"),
    (Foot, "foot feet fuss fuß jiao pie pied piede 발 стопа 脚掌 脚部"),
    (Ankle, "tornozelo kostka ayakbilegi enkel ankel nilkka lodyzhka"),
    (Ankle, "ankle tobillo cheville caviglia 발목 ashikubi jiaohuai jiaowan 足首 脚踝 脚腕 踝"),
    (
        Toes,
        "toe toes ball tsumasaki jiaozhi jiaojian zeh zehe zehen orteil orteils 발가락 носок つま先 つまさき 爪先 足先 脚趾 脚尖",
    ),
    (Tail, "queue cola coda cauda rabo ogon kuyruk staart svans hvost ocas hanta"),
    (Tail, "tail shippo weiba schwanz 尾 尾巴 しっぽ"),
    (Twist, "twist twst roll nejiri 捩 捩り"),
    // Words of inverse kinematics, controls, ends, sockets.
    (Control, "ik fk pole target ctrl ctl control"),
    (Appendix, "end tip nub slot handslot socket attach attachment helper"),
    (
        Appendix,
        "effector goal hint aim lookat locator loc null dummy marker ダミー dummies share correct corrective",
    ),
    (
        Appendix,
        "weapon prop sword gun rifle pistol shield bow quiver axe staff sec adj phys dyn jiggle spring",
    ),
    // Fingers.
    (
        Appendix,
        "thumb index middle ring pinky little finger fingers metacarpal metacarpals carpal pointer heel",
    ),
    (
        Appendix,
        "metatarsal metatarsals oyayubi hitosashi nakayubi kusuriyubi koyubi yubi muzhi shizhi zhongzhi wumingzhi",
    ),
    (
        Appendix,
        "xiaozhi shouzhi daumen zeigefinger mittelfinger ringfinger 指 親指 人指 中指 薬指 小指 拇指 食指 无名指 手指",
    ),
    (
        Appendix,
        "pouce doigt doigts majeur annulaire auriculaire pulgar dedo dedos pollice dito dita anulare medio duim vinger tumme finger",
    ),
    (Appendix, "kciuk palec palce parmak palets sormi peukalo polegar talon"),
    // Face.
    (
        Appendix,
        "eye eyes eyeball jaw tongue lip lips brow eyebrow lid eyelid lash teeth tooth nose nostril mouth cheek",
    ),
    (
        Appendix,
        "chin face facial forehead temple ear ears hair ponytail pigtail braid bang bangs bun beard mustache",
    ),
    (
        Appendix,
        "目 両目 右目 左目 眼 舌 口 耳 髪 头发 頭髪 前髪 後髪 眉 歯 kami mimi hitomi toufa yanjing zuiba",
    ),
    (
        Appendix,
        "oeil yeux mâchoire machoire bouche langue sourcil cheveux oreille ojo ojos mandibula boca lengua pelo oreja",
    ),
    (
        Appendix,
        "occhio occhi mascella bocca lingua capelli orecchio olho olhos cabelo orelha oko oczy szczeka wlosy goz çene sac",
    ),
    (Appendix, "auge augen ohr kiefer unterkiefer zunge"),
    // Cloth, gear and soft parts.
    (
        Appendix,
        "cape cloak skirt dress coat cloth sleeve hood scarf belt strap bag backpack pouch helmet hat ribbon",
    ),
    (Appendix, "breast breasts bust boob butt buttock glute muscle pad armor tie qunzi スカート 乳 袖"),
];

/// Words that mean a body part only if other names of the rig are in the same language: the words that identify the
/// language, and pairs of word and meaning.
pub(super) const LANGUAGES: &[(&str, &[(&str, &str)])] = &[
    (
        "bras jambe cuisse pied tete tête bassin épaule epaule mollet",
        &[("main", "hand"), ("g", "left"), ("d", "right"), ("dr", "right"), ("ga", "left")],
    ),
    (
        "bacak ayak omuz dirsek kalca kalça",
        &[
            ("sol", "left"),
            ("sag", "right"),
            ("el", "hand"),
            ("bas", "head"),
            ("kol", "arm"),
            ("bel", "spine"),
        ],
    ),
    ("bovenbeen onderbeen bovenarm onderarm", &[("been", "leg")]),
];

/// Two words written as a few letters: OptiTrack's "LUArm", "RFArm".
const PAIRS: &[(&str, [Word; 2])] =
    &[("lu", [LEFT, Upper]), ("ru", [RIGHT, Upper]), ("lf", [LEFT, Fore]), ("rf", [RIGHT, Fore])];

/// Returns the meaning of a whole word; `None` if it is unknown.
pub(super) fn meaning(word: &str) -> Option<Word> {
    let has_word = |&&(_, words): &&(Word, &str)| words.split(' ').any(|known| known == word);
    WORDS.iter().find(has_word).map(|&(meaning, _)| meaning)
}

/// Returns the meanings of a word, known as a whole or as joined known words ("lefttoebase", "lthigh", "左足首"); `None`
/// if a part of it is unknown.
pub(super) fn meanings(word: &str) -> Option<Vec<Word>> {
    if let Some(whole) = meaning(word) {
        return Some(vec![whole]);
    }
    if let Some((_, pair)) = PAIRS.iter().find(|(known, _)| *known == word) {
        return Some(pair.to_vec());
    }
    glued(word, true)
}

/// Splits a text into the fewest known words; among equals, the split with the longest first word.
fn glued(text: &str, at_start: bool) -> Option<Vec<Word>> {
    let mut best: Option<Vec<Word>> = None;
    for (end, _) in
        text.char_indices().skip(1).chain([(text.len(), ' ')]).collect::<Vec<_>>().into_iter().rev()
    {
        let (head, rest) = text.split_at(end);
        let Some(word) = meaning(head).filter(|_| may_be_glued(head, at_start, rest)) else { continue };
        let tail = if rest.is_empty() { Some(Vec::new()) } else { glued(rest, false) };
        let Some(tail) = tail else { continue };
        if best.as_ref().is_none_or(|best| tail.len() + 1 < best.len()) {
            best = Some([vec![word], tail].concat());
        }
    }
    best
}

/// True if a short word may be part of a joined word: two letters only for "up", "ik" and "fk", one letter only for a
/// side before or after all other letters.
fn may_be_glued(word: &str, at_start: bool, rest: &str) -> bool {
    !word.is_ascii()
        || word.len() > 2
        || matches!(word, "up" | "ik" | "fk")
        || matches!(word, "l" | "r") && (at_start && rest.len() > 2 || !at_start && rest.is_empty())
}
