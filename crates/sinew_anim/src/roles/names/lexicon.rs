//! Words that rigs are named with, and what each of them says.

use super::super::role::Side;

/// Meaning of one word of a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Word {
    /// Nothing about the body: what exporters put before and after their names.
    Noise,
    Side(Side),
    /// The part nearer to the trunk, or higher in it.
    Upper,
    Lower,
    /// Between upper and lower: of the spine another part, of a limb one that no human has.
    Mid,
    /// Before "arm" the lower one, before "leg" one of a beast.
    Fore,
    /// Front of a body on four legs; `Back` is its hind part.
    Front,
    Back,
    Paw,
    Arm,
    Leg,
    /// Leg or foot, as Japanese has it.
    LegOrFoot,
    Body,
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
    /// Turns with a bone's end: a helper beside a limb, a plain bone in the neck.
    Twist,
    /// Control that an animator moves, and no part of a body: an appendix too, as long as it moves no skin to speak of.
    Control,
    /// Makes the joint an appendix whatever else its name says.
    Appendix,
}

use Word::*;

const LEFT: Word = Word::Side(super::super::role::Side::Left);
const RIGHT: Word = Word::Side(super::super::role::Side::Right);

/// Words by meaning, in lower case. Words of up to two letters are only understood where they stand alone.
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
    (LEFT, "왼쪽 왼 левая левый левое лев л"),
    (RIGHT, "r right rgt rt rechts migi you 右 みぎ"),
    (RIGHT, "derecha derecho der dcha droite droit destra destro dx direita direito rechte rechter rechtes"),
    (RIGHT, "오른쪽 오른 правая правый правое прав п"),
    (Upper, "upper up shang 上"),
    (Lower, "lower low lo xia 下"),
    (Mid, "mid zhong 中"),
    (Fore, "fore"),
    (Front, "front vorder vorn qian"),
    (Back, "back hind rear hinter hou"),
    (Paw, "paw hoof pfote huf"),
    (Arm, "arm ude bi gebo brazo bras braccio braco 腕 うで 臂 手臂 胳膊 팔 рука"),
    (Leg, "leg tui bein pierna jambe gamba perna 腿 脚部 다리 нога"),
    (LegOrFoot, "ashi 足 脚 あし"),
    (Body, "body 半身 hanshin"),
    (
        Pelvis,
        "pelvis becken kahanshin kanpan gupen tunbu koshibone bassin bacino pelve 골반 таз 骨盆 骨盤 臀 臀部",
    ),
    (Hip, "hips hip huefte hüfte kuan kuabu cadera hanche anca quadril 髋 尻 엉덩이"),
    (Spine, "spine chest torso abdomen waist thorax ribcage ribs stomach belly sternum lumbar trunk ab abs"),
    (Spine, "sebone koshi mune jouhanshin joohanshin hara yao xiong xiongbu jizhu jizhui fubu yaobu"),
    (Spine, "bauch brust wirbel wirbelsaeule ruecken 脊椎 脊柱 腰 胸 胸部 腹 背骨 躯干"),
    (
        Spine,
        "columna pecho torse colonne poitrine colonna petto coluna peito 척추 가슴 허리 позвоночник грудь",
    ),
    (Neck, "neck kubi jing jingbu bozi hals cuello cou collo pescoco 목 шея 首 颈 頸 脖子 脖"),
    (Head, "head skull atama tou toubu kopf cabeza tete testa cabeca 머리 голова 頭 头 头部 あたま"),
    (
        Shoulder,
        "shoulder shldr shoulders kata jian jianbang schulter hombro epaule spalla ombro 어깨 肩 肩膀 かた",
    ),
    (
        Clavicle,
        "clavicle clav collar collarbone scapula sakotsu suogu schluesselbein schulterblatt 锁骨 鎖骨",
    ),
    (Clavicle, "clavicula clavicule clavicola 쇄골 ключица"),
    (
        UpperArm,
        "uarm humerus bicep biceps oberarm jouwan dabi shangbi nikoude 위팔 상완 плечо 上臂 大臂 上腕 二の腕",
    ),
    (LowerArm, "forearm elbow farm unterarm hiji zenwan xiaobi qianbi 前腕 前臂 小臂 ひじ 肘"),
    (LowerArm, "antebrazo avantbras avambraccio antebraco codo coude gomito 아래팔 전완 팔꿈치 предплечье"),
    (Hand, "hand palm fist hnd tenohira shou shouzhang mano 손 кисть 手 て 手掌"),
    (Wrist, "wrist tekubi shouwan handgelenk 手首 手腕"),
    (
        UpperLeg,
        "thigh femur oberschenkel momo futomomo datui muslo cuisse coscia coxa 허벅지 бедро 大腿 太もも 太腿 もも",
    ),
    (
        LowerLeg,
        "calf shin shank knee tibia crus unterschenkel wade knie hiza sune xiaotui xigai 小腿 ひざ 膝 脛 膝盖",
    ),
    (LowerLeg, "pantorrilla mollet polpaccio panturrilha rodilla genou ginocchio 종아리 무릎 голень колено"),
    (Foot, "foot feet fuss fuß jiao pie pied piede 발 стопа 脚掌 脚部"),
    (Ankle, "ankle tobillo cheville caviglia 발목 ashikubi jiaohuai jiaowan 足首 脚踝 脚腕 踝"),
    (
        Toes,
        "toe toes ball tsumasaki jiaozhi jiaojian zeh zehe zehen orteil orteils 발가락 носок つま先 つまさき 爪先 足先 脚趾 脚尖",
    ),
    (Tail, "tail shippo weiba schwanz 尾 尾巴 しっぽ"),
    (Twist, "twist twst roll nejiri 捩 捩り"),
    // Inverse kinematics, controls, ends, sockets.
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
    (Appendix, "auge augen ohr kiefer unterkiefer zunge"),
    // Cloth, gear and soft parts.
    (
        Appendix,
        "cape cloak skirt dress coat cloth sleeve hood scarf belt strap bag backpack pouch helmet hat ribbon",
    ),
    (Appendix, "breast breasts bust boob butt buttock glute muscle pad armor tie qunzi スカート 乳 袖"),
];

/// Two words that are written as one of a few letters: OptiTrack's "LUArm", "RFArm".
const PAIRS: &[(&str, [Word; 2])] =
    &[("lu", [LEFT, Upper]), ("ru", [RIGHT, Upper]), ("lf", [LEFT, Fore]), ("rf", [RIGHT, Fore])];

/// Meaning of a whole word.
pub(super) fn meaning(word: &str) -> Option<Word> {
    let said = |&&(_, words): &&(Word, &str)| words.split(' ').any(|known| known == word);
    WORDS.iter().find(said).map(|&(meaning, _)| meaning)
}

/// Meanings of a word, whole or as several known ones glued together ("lefttoebase", "lthigh", "左足首"); `None` where some
/// of it is unknown.
pub(super) fn meanings(word: &str) -> Option<Vec<Word>> {
    if let Some(whole) = meaning(word) {
        return Some(vec![whole]);
    }
    if let Some((_, pair)) = PAIRS.iter().find(|(known, _)| *known == word) {
        return Some(pair.to_vec());
    }
    glued(word, true)
}

/// The fewest known words that make up a text, the longest first among equals.
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

/// Few letters say too little inside a word: two do for "up", one for a side before or after all the rest.
fn may_be_glued(word: &str, at_start: bool, rest: &str) -> bool {
    !word.is_ascii()
        || word.len() > 2
        || matches!(word, "up" | "ik" | "fk")
        || matches!(word, "l" | "r") && (at_start && rest.len() > 2 || !at_start && rest.is_empty())
}
